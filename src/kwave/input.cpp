// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/files.hpp"

#include "base/error.hpp"
#include "storage/input/input_files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <hdf5.h>
#include <numbers>

namespace shearwake::kwave {
namespace {

using pstd::Field;
using pstd::Node;

/// Sizes above these are not plausible, and products of smaller ones do not overflow.
constexpr std::uint64_t most_points = 1u << 20, most_steps = 1u << 30;

} // namespace

// ---- the kind of file, and the grid

void Reader::check_kind() {
    const auto attribute = [&](const char* name) {
        return text_attribute(file_, name).value_or("");
    };
    if (const std::string type = attribute("file_type"); type != "input")
        throw UsageError(fmt::format("it is not an input file of k-Wave: its attribute file_type "
                                     "is \"{}\", not \"input\"",
                                     type));
    const std::string major = attribute("major_version"), minor = attribute("minor_version");
    if (major != "1" || (minor != "0" && minor != "1" && minor != "2"))
        throw UsageError(fmt::format("it has version {}.{} of the format of k-Wave; versions 1.0 "
                                     "to 1.2 are supported",
                                     major, minor));
    input_.description = attribute("file_description");
    if (!has("elastic_flag") || integer("elastic_flag") != 1)
        throw UsageError(
            "elastic_flag is not 1: it is an acoustic file, which kspaceFirstOrder-OMP "
            "of k-Wave runs");
    constexpr std::pair<const char*, const char*> without[] = {
        {"nonlinear_flag", "a nonlinear medium"},
        {"nonuniform_grid_flag", "a nonuniform grid"},
        {"axisymmetric_flag", "axial symmetry"},
        {"transducer_source_flag", "a transducer"},
        {"p_source_flag", "a pressure source or time reversal"}};
    for (const auto& [name, what] : without)
        if (integer(name) != 0)
            throw UsageError(fmt::format("{} is {}: the elastic scheme does not support {}", name,
                                         input_.integers[name], what));
}

void Reader::read_grid() {
    auto& grid = input_.setup.grid;
    grid.is_plane = integer("Nz") == 1; // the order of the axes follows from it
    for (std::size_t a = 0; a < 3; ++a) {
        const std::string name = fmt::format("N{}", axis(a));
        const std::uint64_t least = kwave_axis(a) == 2 ? 1 : 2;
        n_[a] = integer(name);
        if (n_[a] < least || n_[a] > most_points)
            throw UsageError(
                fmt::format("{} is {}; it must be {} to {}", name, n_[a], least, most_points));
        grid.points[a] = static_cast<std::ptrdiff_t>(n_[a]);
        grid.spacing_m[a] = number(fmt::format("d{}", axis(a)));
    }
    grid.dt_s = number("dt");
    const std::uint64_t steps = integer("Nt");
    if (steps < 1 || steps > most_steps)
        throw UsageError(fmt::format("Nt is {}; it must be 1 to {}", steps, most_steps));
    input_.steps = static_cast<std::ptrdiff_t>(steps);
    number("c_ref");
    slabs_ = pstd::slabs_of(grid, ranks_, rank_);
}

/// The differences between the operators of the file and those of the scheme must be rounding
/// errors: 1e-5 of the largest value, where numbers of 32 bits have 6e-8.
void Reader::check_operators() const {
    const auto check = [&](const std::string& name, std::size_t a, hsize_t count, double half_cells,
                           bool derivative) {
        const Reals found = reals(name, line_shape(a, 2 * count), Kind::complex);
        const auto n = static_cast<double>(n_[a]);
        const double d_m = input_.setup.grid.spacing_m[a],
                     largest = derivative ? std::numbers::pi / d_m : 1.0;
        for (std::size_t i = 0; i < count; ++i) {
            const auto m = static_cast<double>(i);
            const double k = 2.0 * std::numbers::pi / (n * d_m) * (2.0 * m < n ? m : m - n);
            const std::complex<double> shift = std::polar(1.0, half_cells * k * d_m / 2.0),
                                       expected = derivative ? std::complex(0.0, k) * shift : shift,
                                       value(found[2 * i], found[2 * i + 1]);
            // At the Nyquist frequency of a half spectrum the sign of k is a convention.
            const bool nyquist = 2.0 * m == n;
            if (std::min(std::abs(value - expected),
                         nyquist ? std::abs(value - std::conj(expected)) : 1e300) > 1e-5 * largest)
                throw UsageError(fmt::format(
                    "{} differs from the operator of a grid that is staggered by half a cell: the "
                    "file was saved with 'UseSG' false, or dx, dy, dz have been changed",
                    name));
        }
    };
    for (std::size_t a = 0; a < 3; ++a) {
        const bool is_x = kwave_axis(a) == 0;
        const hsize_t half = n_[a] / 2 + 1, count = is_x ? half : n_[a];
        const char* end = is_x ? "_r" : "";
        check(fmt::format("dd{}_k_shift_pos{}", axis(a), end), a, count, 1.0, true);
        check(fmt::format("dd{}_k_shift_neg{}", axis(a), end), a, count, -1.0, true);
        check(fmt::format("{}_shift_neg_r", axis(a)), a, half, -1.0, false);
    }
}

// ---- absorbing layer

void Reader::read_layer() {
    auto& pml = input_.setup.pml;
    pml.reference_speed_m_s = input_.numbers["c_ref"];
    for (std::size_t a = 0; a < 3; ++a) {
        const char* axis = this->axis(a);
        const std::string size = fmt::format("pml_{}_size", axis);
        pml.points[a] = static_cast<std::ptrdiff_t>(flag(size, n_[a] / 2));
        pml.strength_1[a] = number(fmt::format("pml_{}_alpha", axis), Sign::not_negative);
        const bool is_single = n_[a] == 1; // the z of a plane
        const auto profile = [&](const std::string& name) {
            const Reals found = reals(name, line_shape(a, n_[a]));
            std::vector<double> factors;
            for (std::size_t i = 0; i < found.size(); ++i) {
                factors.push_back(found[i]);
                if (factors[i] < (is_single ? 1.0 : 0.0) || factors[i] > 1.0)
                    throw UsageError(fmt::format(
                        "{} is {:.7g} at index {}; {}", name, factors[i], i + 1,
                        is_single ? "it must be 1: a plane has no absorbing layer along z"
                                  : "factors of the absorbing layer must be 0 to 1"));
            }
            return factors;
        };
        const std::string half = fmt::format("{0}_sg{0}", axis);
        pml.given[a] = {pstd::PmlProfile{profile(fmt::format("pml_{}", axis)),
                                         profile(fmt::format("mpml_{}", axis))},
                        pstd::PmlProfile{profile("pml_" + half), profile("mpml_" + half)}};
    }
}

// ---- sources and sensor

void Reader::read_sources(const std::string& letter, std::span<const Field> fields) {
    pstd::Grid& grid = input_.setup.grid;
    std::vector<std::uint64_t> samples;
    for (const Field field : fields)
        samples.push_back(flag(fmt::format("{}_source_flag", field_name(field)), most_steps));
    if (std::all_of(samples.begin(), samples.end(), [](auto n) { return n == 0; })) return;
    const bool dirichlet = flag(letter + "_source_mode", letter == "u" ? 2 : 1) == 0;
    flag(letter + "_source_many", 1);
    const std::string name = letter + "_source_index";
    const std::vector<std::ptrdiff_t> at = indices(name, node_count());
    if (at.empty()) throw UsageError(name + " contains no nodes");
    std::vector<std::ptrdiff_t> sorted = at;
    std::sort(sorted.begin(), sorted.end());
    if (const auto twice = std::adjacent_find(sorted.begin(), sorted.end()); twice != sorted.end())
        throw UsageError(fmt::format("{} contains {} more than once", name, *twice + 1));
    std::vector<Node> nodes;
    for (const std::ptrdiff_t index : at)
        nodes.push_back(node_of(index));
    for (std::size_t i = 0; i < fields.size(); ++i) {
        if (samples[i] == 0) continue;
        const std::string input = fmt::format("{}_source_input", field_name(fields[i]));
        const hsize_t rows = shape_of(open(input, Kind::real), input)[2];
        if (rows != 1 && rows != at.size())
            throw UsageError(fmt::format("{} has {} series for {} source nodes; there must be one, "
                                         "or one per node: the mask was labelled, and the file "
                                         "does not contain the labels",
                                         input, rows, at.size()));
        const auto values = std::make_shared<const Reals>(reals(input, {1, samples[i], rows}));
        pstd::Source source{.field = fields[i],
                            .mode = dirichlet ? pstd::SourceMode::dirichlet
                                              : pstd::SourceMode::additive,
                            .scaling = pstd::SourceScaling::none,
                            .nodes = nodes,
                            .samples = static_cast<std::ptrdiff_t>(samples[i])};
        // Dirichlet stresses: the file has one third of the value, in a plane one half, which each
        // part is set to. The other stresses and PlacedSource divide by this number as well.
        const double scale = is_velocity(fields[i]) ? 1.0 : grid.is_plane ? 2.0 : 3.0;
        source.values = [values, rows, scale](std::ptrdiff_t sample,
                                              std::span<const std::size_t> which,
                                              std::span<double> out) {
            const std::size_t first = static_cast<std::size_t>(sample) * rows;
            for (std::size_t n = 0; n < which.size(); ++n)
                out[n] = scale * (*values)[first + (rows == 1 ? 0 : which[n])];
        };
        grid.moves_in_plane = grid.moves_in_plane && fields[i] != Field::ux &&
                              fields[i] != Field::sxy && fields[i] != Field::sxz;
        input_.setup.sources.push_back(std::move(source));
    }
}

void Reader::read_sensor() {
    const std::uint64_t type = flag("sensor_mask_type", 2);
    if (type == 1) return read_cuboids();
    Shape shape = {1, node_count(), 1};
    const std::string name = "sensor_mask_weights";
    if (type == 2) shape = shape_of(open(name, Kind::real), name);
    pstd::SensorPoints& sensor = input_.sensor;
    for (const std::ptrdiff_t index : indices("sensor_mask_index", shape[1] * shape[2]))
        sensor.nodes.push_back(node_of(index));
    if (type == 0 || sensor.nodes.empty()) return;
    sensor.nodes_of_a_point = shape[2];
    const Reals weights = reals(name, {1, sensor.nodes.size() / shape[2], shape[2]});
    for (std::size_t i = 0; i < weights.size(); ++i)
        sensor.weights.push_back(weights[i]);
}

void Reader::read_cuboids() {
    const std::string name = "sensor_mask_corners";
    const hsize_t count = shape_of(open(name, Kind::integer), name)[1];
    if (count < 1 || count > 1'000'000)
        throw UsageError(fmt::format("{} has {} cuboids; it must have 1 to 1000000", name, count));
    const h5::Id dataset = open(name, Kind::integer, {1, count, 6});
    std::vector<std::uint64_t> corners(6 * count);
    h5::check(
        H5Dread(dataset.raw(), H5T_NATIVE_UINT64, H5S_ALL, H5S_ALL, H5P_DEFAULT, corners.data()),
        "read " + name);
    double nodes = 0.0;
    for (std::size_t c = 0; c < count; ++c) {
        Cuboid cuboid;
        double cuboid_nodes = 1.0;
        for (std::size_t a = 0; a < 3; ++a) {
            const std::size_t k = kwave_axis(a);
            const std::uint64_t first = corners[6 * c + k], last = corners[6 * c + 3 + k];
            if (first < 1 || last < first || last > n_[a])
                throw UsageError(fmt::format(
                    "{}: cuboid {} has the corners {} and {} along {}; they must be ordered and 1 "
                    "to {}",
                    name, c + 1, first, last, axes[k], n_[a]));
            cuboid.first[k] = static_cast<std::ptrdiff_t>(first) - 1;
            cuboid.last[k] = static_cast<std::ptrdiff_t>(last) - 1;
            cuboid_nodes *= static_cast<double>(cuboid.count(k));
        }
        nodes += cuboid_nodes;
        input_.cuboids.push_back(cuboid);
    }
    require_memory(name, nodes * sizeof(Node));
    input_.sensor.nodes.reserve(static_cast<std::size_t>(nodes));
    for (const Cuboid& cuboid : input_.cuboids)
        for (std::ptrdiff_t z = cuboid.first[2]; z <= cuboid.last[2]; ++z)
            for (std::ptrdiff_t y = cuboid.first[1]; y <= cuboid.last[1]; ++y)
                for (std::ptrdiff_t x = cuboid.first[0]; x <= cuboid.last[0]; ++x) {
                    const Node at{x, y, z};
                    input_.sensor.nodes.push_back(
                        {at[kwave_axis(0)], at[kwave_axis(1)], at[kwave_axis(2)]});
                }
}

Input Reader::input() {
    check_kind();
    read_grid();
    read_layer();
    check_operators();
    read_material();
    constexpr Field velocities[] = {Field::ux, Field::uy, Field::uz},
                    stresses[] = {Field::sxx, Field::syy, Field::szz,
                                  Field::sxy, Field::sxz, Field::syz};
    input_.setup.grid.moves_in_plane = input_.setup.grid.is_plane;
    read_sources("u", velocities);
    read_sources("s", stresses);
    // The samples of sxx, syy and szz contain p0 already.
    if (flag("p0_source_flag", 1) == 1) {
        open("p0_source_input", Kind::real, field_shape());
        field("p0_source_input"); // throws if a value is not finite
    }
    read_sensor();
    return std::move(input_);
}

Input read_input(const std::filesystem::path& path, int ranks, int rank, double available_B) {
    return storage::read_user_file(
        path, [&](hid_t file) { return Reader(file, ranks, rank, available_B).input(); });
}

} // namespace shearwake::kwave
