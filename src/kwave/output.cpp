// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/files.hpp"

#include "pipeline/provenance.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <fmt/chrono.h>
#include <fmt/format.h>
#include <numeric>
#include <unistd.h>

namespace shearwake::kwave {

using pstd::Recorder;

namespace {

enum class Numbers { real, integer };

/// Creates a dataset of real numbers, or of unsigned integers of 64 bits, with k-Wave's attributes.
h5::Id create_dataset(const OutputFile& output, const std::string& name,
                      std::span<const hsize_t> shape, Numbers numbers) {
    const h5::Id space(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
                       H5Sclose, "create a dataspace"),
        layout(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, "create a property list");
    if (output.gzip_level > 0) {
        // Chunks of complete rows, of about a megabyte.
        std::vector<hsize_t> chunk(shape.begin(), shape.end());
        hsize_t values = std::accumulate(chunk.begin(), chunk.end(), hsize_t{1}, std::multiplies());
        for (hsize_t& extent : chunk) {
            const hsize_t rest = values / extent;
            extent = std::clamp<hsize_t>((hsize_t{1} << 18) / rest, 1, extent);
            values = rest * extent;
        }
        h5::check(H5Pset_chunk(layout.raw(), static_cast<int>(chunk.size()), chunk.data()),
                  "set chunks");
        h5::check(H5Pset_deflate(layout.raw(), static_cast<unsigned>(output.gzip_level)),
                  "compress");
    }
    const hid_t type = numbers == Numbers::integer ? H5T_STD_U64LE
                       : output.doubles            ? H5T_IEEE_F64LE
                                                   : H5T_IEEE_F32LE;
    h5::Id dataset(H5Dcreate2(output.file, name.c_str(), type, space.raw(), H5P_DEFAULT,
                              layout.raw(), H5P_DEFAULT),
                   H5Dclose, "create " + name);
    const std::string real = output.doubles ? "double" : "float";
    h5::put_attribute(dataset.raw(), "data_type", numbers == Numbers::integer ? "long" : real);
    h5::put_attribute(dataset.raw(), "domain_type", std::string("real"));
    return dataset;
}

/// Creates a dataset of all these values, double or std::uint64_t.
void write_dataset(const OutputFile& output, const std::string& name,
                   std::span<const hsize_t> shape, Numbers numbers, const void* values) {
    const hid_t type = numbers == Numbers::integer ? H5T_NATIVE_UINT64 : H5T_NATIVE_DOUBLE;
    h5::check(H5Dwrite(create_dataset(output, name, shape, numbers).raw(), type, H5S_ALL, H5S_ALL,
                       H5P_DEFAULT, values),
              "write " + name);
}

/// Values that rank 0 gathers and writes at a time.
constexpr std::size_t most_values_at_once = std::size_t{1} << 22;

/// The datasets of a record at points, one or one per cuboid, with their shapes.
struct Datasets {
    std::vector<h5::Id> ids;
    std::vector<std::vector<hsize_t>> shapes;
};

Datasets create_datasets(const OutputFile& output, const Recorder::Record& record,
                         std::size_t samples, const Input& input) {
    Datasets datasets;
    const auto add = [&](const OutputFile& to, const std::string& name,
                         std::vector<hsize_t> shape) {
        datasets.ids.push_back(create_dataset(to, name, shape, Numbers::real));
        datasets.shapes.push_back(std::move(shape));
    };
    if (input.cuboids.empty()) {
        add(output, record.name, {1, samples, input.sensor.size()});
        return datasets;
    }
    const h5::Id group = h5::create_group(output.file, record.name);
    const OutputFile in_group{group.raw(), output.doubles, output.gzip_level};
    for (std::size_t c = 0; c < input.cuboids.size(); ++c) {
        std::vector<hsize_t> shape;
        if (record.is_series()) shape.push_back(samples);
        for (const std::size_t axis : {2u, 1u, 0u})
            shape.push_back(static_cast<hsize_t>(input.cuboids[c].count(axis)));
        add(in_group, std::to_string(c + 1), std::move(shape));
    }
    return datasets;
}

/// Blocks of samples are gathered on rank 0.
void write_points(const OutputFile& output, const Recorder& recorder,
                  const Recorder::Record& record, const Input& input, const Comm& team) {
    const bool is_series = record.is_series();
    const auto samples = is_series ? static_cast<std::size_t>(recorder.samples()) : std::size_t{1};
    const std::size_t nodes = input.sensor.size();
    Datasets datasets;
    if (team.is_root()) datasets = create_datasets(output, record, samples, input);
    const std::size_t most =
        std::clamp<std::size_t>(most_values_at_once / std::max<std::size_t>(nodes, 1), 1, samples);
    for (std::size_t first = 0; first < samples; first += most) {
        const std::size_t count = std::min(most, samples - first);
        const std::vector<double> block = recorder.samples_of(record, first, count, team);
        if (!team.is_root()) continue;
        std::size_t first_node = 0;
        for (std::size_t d = 0; d < datasets.ids.size(); ++d) {
            const std::vector<hsize_t>& shape = datasets.shapes[d];
            const bool is_list = input.cuboids.empty();
            std::vector<hsize_t> start(shape.size(), 0), extent = shape;
            if (is_series) {
                start[is_list ? 1 : 0] = first;
                extent[is_list ? 1 : 0] = count;
            }
            const hsize_t in_dataset =
                std::accumulate(extent.begin(), extent.end(), hsize_t{1}, std::multiplies()) /
                count;
            std::vector<double> part;
            for (std::size_t s = 0; s < count; ++s) {
                const auto from =
                    block.begin() + static_cast<std::ptrdiff_t>(s * nodes + first_node);
                part.insert(part.end(), from, from + static_cast<std::ptrdiff_t>(in_dataset));
            }
            first_node += in_dataset;
            const h5::Id in_file(H5Dget_space(datasets.ids[d].raw()), H5Sclose, "find a dataspace"),
                memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                       H5Sclose, "create a dataspace");
            h5::check(H5Sselect_hyperslab(in_file.raw(), H5S_SELECT_SET, start.data(), nullptr,
                                          extent.data(), nullptr),
                      "select a block");
            h5::check(H5Dwrite(datasets.ids[d].raw(), H5T_NATIVE_DOUBLE, memory.raw(),
                               in_file.raw(), H5P_DEFAULT, part.data()),
                      "write " + record.name);
        }
    }
}

void write_grid(const OutputFile& output, const std::string& name, const std::vector<double>& all,
                const pstd::Grid& grid) {
    const auto [nx, ny, nz] = grid.points;
    std::vector<double> turned(all.size());
    for (std::ptrdiff_t x = 0, at = 0; x < nx; ++x)
        for (std::ptrdiff_t y = 0; y < ny; ++y)
            for (std::ptrdiff_t z = 0; z < nz; ++z, ++at)
                turned[static_cast<std::size_t>((z * ny + y) * nx + x)] =
                    all[static_cast<std::size_t>(at)];
    write_dataset(output, name, kwave_shape(grid, grid.points), Numbers::real, turned.data());
}

} // namespace

void write_facts(const OutputFile& output, const Arguments& arguments, const Input& input,
                 long steps, long done, Phases& phases, int ranks, double memory_B) {
    constexpr hsize_t one[] = {1, 1, 1};
    std::map<std::string, std::uint64_t> integers = input.integers;
    integers["Nt"] = static_cast<std::uint64_t>(steps);
    integers["t_index"] = static_cast<std::uint64_t>(done);
    for (const auto& [name, value] : integers)
        if (!name.starts_with("sensor_mask"))
            write_dataset(output, name, one, Numbers::integer, &value);
    for (const auto& [name, value] : input.numbers)
        write_dataset(output, name, one, Numbers::real, &value);
    if (arguments.copies_sensor_mask) {
        const auto& n = input.setup.grid.points;
        const pstd::SensorPoints& sensor = input.sensor;
        std::vector<std::uint64_t> values;
        const std::uint64_t type = input.integers.at("sensor_mask_type");
        write_dataset(output, "sensor_mask_type", one, Numbers::integer, &type);
        std::array<hsize_t, 3> shape = {1, sensor.size(), sensor.nodes_of_a_point};
        if (type == 2)
            write_dataset(output, "sensor_mask_weights", shape, Numbers::real,
                          sensor.weights.data());
        if (type != 1) {
            for (const pstd::Node& node : sensor.nodes)
                values.push_back(
                    static_cast<std::uint64_t>((node[2] * n[1] + node[1]) * n[0] + node[0] + 1));
            shape = {1, 1, values.size()};
        } else {
            for (const Cuboid& cuboid : input.cuboids)
                for (const pstd::Node& corner : {cuboid.first, cuboid.last})
                    for (const std::ptrdiff_t index : corner)
                        values.push_back(static_cast<std::uint64_t>(index + 1));
            shape = {1, input.cuboids.size(), 6};
        }
        write_dataset(output, type == 1 ? "sensor_mask_corners" : "sensor_mask_index", shape,
                      Numbers::integer, values.data());
    }
    std::array<char, 256> host{};
    ::gethostname(host.data(), host.size() - 1);
    const std::time_t now = std::time(nullptr);
    const auto seconds = [](double s) { return fmt::format("{:8.2f}s", s); };
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, std::string>>{
             {"file_type", "output"},
             {"created_by", "shearwake " + pipeline::program_git_id()},
             {"creation_date", fmt::format("{:%d/%m/%y, %H:%M:%S}", fmt::localtime(now))},
             {"file_description", input.description},
             {"major_version", "1"},
             {"minor_version", "2"},
             {"host_names", host.data()},
             {"number_of_cpu_cores", std::to_string(ranks)},
             {"data_loading_phase_execution_time", seconds(phases.loading_s)},
             {"pre-processing_phase_execution_time", seconds(phases.preparing_s)},
             {"simulation_phase_execution_time", seconds(phases.stepping_s)},
             {"post-processing_phase_execution_time", seconds(phases.next())},
             {"total_execution_time", seconds(seconds_since(phases.began))},
             {"peak_core_memory_in_use", fmt::format("{:.0f} MB", 1e-6 * memory_B / ranks)},
             {"total_memory_in_use", fmt::format("{:.0f} MB", 1e-6 * memory_B)}})
        h5::put_attribute(output.file, name, value);
}

void write_records(const OutputFile& output, const Recorder& recorder, const Input& input,
                   const Comm& team) {
    for (const Recorder::Record& record : recorder.records()) {
        if (!record.is_output) continue;
        if (!record.is_grid()) {
            write_points(output, recorder, record, input, team);
            continue;
        }
        const std::vector<double> all = recorder.grid_of(record, team);
        if (team.is_root()) write_grid(output, record.name, all, input.setup.grid);
    }
}

} // namespace shearwake::kwave
