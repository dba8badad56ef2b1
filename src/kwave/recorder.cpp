// SPDX-License-Identifier: BSD-3-Clause
#include "kwave/recorder.hpp"

#include "fft/fftw_real.hpp"
#include "storage/hdf5/h5.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fftw3.h>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <numeric>

namespace shearwake::kwave {
namespace {

using pstd::Field;

/// Quantities: pressure, staggered velocities, velocities at the nodes, and their compressional and
/// shear parts.
constexpr std::array quantities = {"p",
                                   "ux",
                                   "uy",
                                   "uz",
                                   "ux_non_staggered",
                                   "uy_non_staggered",
                                   "uz_non_staggered",
                                   "ux_split_p",
                                   "uy_split_p",
                                   "uz_split_p",
                                   "ux_split_s",
                                   "uy_split_s",
                                   "uz_split_s"};
constexpr std::size_t pressure = 0, staggered = 1, at_nodes = 4, split_p = 7, split_s = 10;

/// Values that rank 0 gathers and writes at a time.
constexpr std::size_t most_values_at_once = std::size_t{1} << 22;

template <class Real>
double pressure_at(const pstd::Stepper<Real>& stepper, std::size_t at) {
    return -(static_cast<double>(stepper.total(Field::sxx)[at]) +
             static_cast<double>(stepper.total(Field::syy)[at]) +
             static_cast<double>(stepper.total(Field::szz)[at])) /
           3.0;
}

template <class Real>
double value_at(const pstd::Stepper<Real>& stepper, std::size_t quantity, std::size_t at) {
    return quantity == pressure
               ? pressure_at(stepper, at)
               : static_cast<double>(stepper.total(static_cast<Field>(quantity - staggered))[at]);
}

} // namespace

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
    h5::put_attribute(dataset.raw(), "data_type",
                      std::string(numbers == Numbers::integer ? "long" : "float"));
    h5::put_attribute(dataset.raw(), "domain_type", std::string("real"));
    return dataset;
}

/// The compressional part of the velocities, u_p = k (k.u)/k^2 in wave number space, on rank 0.
class SplitFields {
public:
    explicit SplitFields(const pstd::Slabs& slabs) : slabs_(slabs) {}

    /// Replaces the staggered velocities [x][y][z] of the entire grid by their compressional part
    /// at the nodes. The real part of the result has no wave of two points along the axis of its
    /// own component, but k-Wave's has that of the other components.
    void project(std::array<std::vector<double>, 3>& u) {
        const std::ptrdiff_t nx = slabs_.nx(), ny = slabs_.ny(), nz = slabs_.nz(),
                             half = nz / 2 + 1;
        std::array<std::vector<std::complex<double>>, 3> spectrum;
        for (std::size_t a = 0; a < 3; ++a) {
            spectrum[a].resize(static_cast<std::size_t>(nx * ny * half));
            transform(u[a], spectrum[a], true);
        }
        const auto wave_number = [&](std::size_t axis, std::ptrdiff_t i) {
            const std::ptrdiff_t n = slabs_.grid.points[axis];
            return 2.0 * std::numbers::pi * static_cast<double>(2 * i <= n ? i : i - n) /
                   (static_cast<double>(n) * slabs_.grid.spacing_m[axis]);
        };
        const double scale = 1.0 / static_cast<double>(nx * ny * nz);
        for (std::ptrdiff_t x = 0, at = 0; x < nx; ++x)
            for (std::ptrdiff_t y = 0; y < ny; ++y)
                for (std::ptrdiff_t z = 0; z < half; ++z, ++at) {
                    const pstd::Node i{x, y, z};
                    std::array<double, 3> k{}, used{};
                    std::complex<double> divergence = 0.0;
                    double k2 = 0.0;
                    for (std::size_t a = 0; a < 3; ++a) {
                        k[a] = wave_number(a, i[a]);
                        used[a] = 2 * i[a] == slabs_.grid.points[a] ? 0.0 : k[a];
                        k2 += k[a] * k[a];
                        divergence += k[a] *
                                      std::polar(1.0, -0.5 * k[a] * slabs_.grid.spacing_m[a]) *
                                      spectrum[a][static_cast<std::size_t>(at)];
                    }
                    for (std::size_t a = 0; a < 3; ++a)
                        spectrum[a][static_cast<std::size_t>(at)] =
                            k2 == 0.0 ? 0.0 : scale * used[a] * divergence / k2;
                }
        for (std::size_t a = 0; a < 3; ++a)
            transform(u[a], spectrum[a], false);
    }

private:
    void transform(std::vector<double>& values, std::vector<std::complex<double>>& spectrum,
                   bool forward) const {
        const int n[3] = {static_cast<int>(slabs_.nx()), static_cast<int>(slabs_.ny()),
                          static_cast<int>(slabs_.nz())};
        auto* raw = fft::FftwOf<double>::raw(spectrum.data());
        const fft::FftwPlan plan =
            fft::checked_plan(forward ? fftw_plan_dft_r2c(3, n, values.data(), raw, FFTW_ESTIMATE)
                                      : fftw_plan_dft_c2r(3, n, raw, values.data(), FFTW_ESTIMATE));
        fftw_execute(plan.get());
    }
    pstd::Slabs slabs_;
};

// ---- what is recorded

std::vector<Recorder::Record> Recorder::records_of(const std::set<std::string>& names) {
    constexpr std::pair<const char*, Statistic> suffixes[] = {
        {"raw", Statistic::series},      {"max", Statistic::max},
        {"min", Statistic::min},         {"rms", Statistic::rms},
        {"max_all", Statistic::max_all}, {"min_all", Statistic::min_all},
        {"final", Statistic::final}};
    std::vector<Record> records;
    const auto add = [&](std::size_t quantity, std::size_t count, const char* suffix,
                         Statistic statistic) {
        for (std::size_t q = quantity; q < quantity + count; ++q)
            records.push_back({statistic == Statistic::series
                                   ? quantities[q]
                                   : fmt::format("{}_{}", quantities[q], suffix),
                               q,
                               statistic,
                               {}});
    };
    for (const auto& [suffix, statistic] : suffixes) {
        if (names.contains(fmt::format("p_{}", suffix))) add(pressure, 1, suffix, statistic);
        if (names.contains(fmt::format("u_{}", suffix))) add(staggered, 3, suffix, statistic);
    }
    if (names.contains("u_non_staggered_raw")) add(at_nodes, 3, "", Statistic::series);
    if (names.contains("u_split_field_raw")) add(split_p, 6, "", Statistic::series);
    return records;
}

double Recorder::memory_B(const Input& input, const std::set<std::string>& records,
                          std::ptrdiff_t samples, int ranks) {
    double grid_points = 1.0;
    for (const std::ptrdiff_t n : input.setup.grid.points)
        grid_points *= static_cast<double>(n);
    const auto nodes = static_cast<double>(input.nodes.size());
    double values = 0.0;
    for (const Record& record : records_of(records)) {
        if (record.statistic == Statistic::series)
            values += nodes * static_cast<double>(samples);
        else if (record.statistic < Statistic::max_all)
            values += nodes;
        else if (record.statistic != Statistic::final)
            values += grid_points;
    }
    return sizeof(double) * values / ranks + 48.0 * nodes;
}

bool Recorder::needs(std::size_t quantity) const {
    return std::any_of(records_.begin(), records_.end(),
                       [&](const Record& record) { return record.quantity == quantity; });
}

Recorder::Recorder(const Input& input, const pstd::Slabs& slabs,
                   const std::set<std::string>& records, std::ptrdiff_t first_step,
                   std::ptrdiff_t steps)
    : input_(input), slabs_(slabs), first_step_(first_step), samples_(steps - first_step + 1),
      records_(records_of(records)), order_(input.nodes.size()), now_(quantities.size()) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const auto x_of = [&](std::size_t node) { return input.nodes[node][0]; };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
    for (std::size_t i = 0; i < order_.size(); ++i) {
        if (x_of(order_[i]) < slabs.x_start()) first_ = i + 1;
        if (slabs.has(x_of(order_[i]))) offsets_.push_back(slabs.offset(input.nodes[order_[i]]));
    }
    count_ = offsets_.size();
    constexpr double infinite = std::numeric_limits<double>::infinity();
    for (Record& record : records_) {
        const bool is_max =
            record.statistic == Statistic::max || record.statistic == Statistic::max_all;
        const bool is_min =
            record.statistic == Statistic::min || record.statistic == Statistic::min_all;
        const auto size =
            record.statistic == Statistic::series ? count_ * static_cast<std::size_t>(samples_)
            : record.statistic < Statistic::max_all
                ? count_
                : static_cast<std::size_t>(
                      record.statistic == Statistic::final ? 0 : slabs_.rows() * slabs_.nz());
        record.values.assign(size, is_max ? -infinite : is_min ? infinite : 0.0);
    }
    if (needs(split_p)) split_ = std::make_unique<SplitFields>(slabs_);
    // The half cell towards lower indices, without the Nyquist frequency: a sum over the line.
    if (!needs(at_nodes) && !split_) return;
    for (std::size_t a = 0; a < 3; ++a) {
        const std::ptrdiff_t n = slabs_.grid.points[a];
        for (std::ptrdiff_t m = 0; m < n; ++m) {
            double sum = 1.0;
            for (std::ptrdiff_t q = 1; 2 * q < n; ++q)
                sum += 2.0 * std::cos(2.0 * std::numbers::pi * static_cast<double>(q) *
                                      (static_cast<double>(m) - 0.5) / static_cast<double>(n));
            move_[a].push_back(sum / static_cast<double>(n));
        }
    }
}

Recorder::~Recorder() = default;

// ---- a step

/// The velocity along an axis at the nodes. Lines along x are summed over the ranks.
template <class Real>
void Recorder::move_to_nodes(const pstd::Stepper<Real>& stepper, std::size_t axis,
                             const Comm& team) {
    const Real* u = stepper.total(static_cast<Field>(axis)).data();
    const std::vector<double>& weights = move_[axis];
    const std::ptrdiff_t n = slabs_.grid.points[axis];
    const std::ptrdiff_t strides[] = {slabs_.ny() * slabs_.pitch, slabs_.pitch, 1};
    const auto line_sum = [&](pstd::Node at, std::ptrdiff_t first, std::ptrdiff_t count) {
        const std::ptrdiff_t place = at[axis];
        at[axis] = first;
        const Real* line = u + slabs_.offset(at);
        double sum = 0.0;
        for (std::ptrdiff_t j = 0; j < count; ++j)
            sum += weights[static_cast<std::size_t>((place - first - j + n) % n)] *
                   static_cast<double>(line[j * strides[axis]]);
        return sum;
    };
    std::vector<double>& values = now_[at_nodes + axis];
    if (axis > 0) {
        values.resize(count_);
        for (std::size_t i = 0; i < count_; ++i)
            values[i] = line_sum(input_.nodes[order_[first_ + i]], 0, n);
        return;
    }
    std::vector<double> sums(order_.size(), 0.0);
    if (slabs_.x_count() > 0)
        for (std::size_t i = 0; i < order_.size(); ++i)
            sums[i] = line_sum(input_.nodes[order_[i]], slabs_.x_start(), slabs_.x_count());
    team.sum(std::span<double>(sums));
    const auto mine = sums.begin() + static_cast<std::ptrdiff_t>(first_);
    values.assign(mine, mine + static_cast<std::ptrdiff_t>(count_));
}

/// A slab without the padding of its rows.
template <class Real>
std::vector<double> dense(const pstd::Slabs& slabs, const pstd::Stepper<Real>& stepper,
                          std::size_t quantity) {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(slabs.rows() * slabs.nz()));
    for (std::ptrdiff_t row = 0; row < slabs.rows(); ++row)
        for (std::ptrdiff_t z = 0; z < slabs.nz(); ++z)
            values.push_back(
                value_at(stepper, quantity, static_cast<std::size_t>(row * slabs.pitch + z)));
    return values;
}

template <class Real>
void Recorder::find_values(const pstd::Stepper<Real>& stepper, const Comm& team) {
    for (std::size_t q = pressure; q < at_nodes; ++q) {
        now_[q].resize(count_);
        for (std::size_t i = 0; i < count_; ++i)
            now_[q][i] = value_at(stepper, q, static_cast<std::size_t>(offsets_[i]));
    }
    for (std::size_t axis = 0; axis < 3 && !move_[0].empty(); ++axis)
        move_to_nodes(stepper, axis, team);
    if (!split_) return;
    std::array<std::vector<double>, 3> u;
    for (std::size_t a = 0; a < 3; ++a)
        u[a] = team.gather(dense(slabs_, stepper, staggered + a));
    if (team.is_root()) split_->project(u);
    for (std::size_t a = 0; a < 3; ++a) {
        std::vector<double> all(order_.size());
        for (std::size_t i = 0; i < all.size() && team.is_root(); ++i) {
            const pstd::Node& n = input_.nodes[order_[i]];
            all[i] =
                u[a][static_cast<std::size_t>((n[0] * slabs_.ny() + n[1]) * slabs_.nz() + n[2])];
        }
        team.broadcast(all);
        now_[split_p + a].assign(all.begin() + static_cast<std::ptrdiff_t>(first_),
                                 all.begin() + static_cast<std::ptrdiff_t>(first_ + count_));
        now_[split_s + a].resize(count_);
        for (std::size_t i = 0; i < count_; ++i)
            now_[split_s + a][i] = now_[at_nodes + a][i] - now_[split_p + a][i];
    }
}

template <class Real>
void Recorder::add(const pstd::Stepper<Real>& stepper, const Comm& team) {
    const std::ptrdiff_t sample = stepper.steps() - first_step_;
    if (sample < 0 || sample >= samples_) return;
    find_values(stepper, team);
    for (Record& record : records_) {
        const std::vector<double>& now = now_[record.quantity];
        const auto each_node = [&](const auto& change) {
            for (std::size_t i = 0; i < count_; ++i)
                change(record.values[i], now[i]);
        };
        const auto each_point = [&](const auto& change) {
            for (std::ptrdiff_t row = 0, at = 0; row < slabs_.rows(); ++row)
                for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z, ++at)
                    change(record.values[static_cast<std::size_t>(at)],
                           value_at(stepper, record.quantity,
                                    static_cast<std::size_t>(row * slabs_.pitch + z)));
        };
        const auto raise = [](double& most, double value) { most = std::max(most, value); };
        const auto lower = [](double& least, double value) { least = std::min(least, value); };
        switch (record.statistic) {
        case Statistic::series:
            for (std::size_t i = 0; i < count_; ++i)
                record.values[i * static_cast<std::size_t>(samples_) +
                              static_cast<std::size_t>(sample)] = now[i];
            break;
        case Statistic::max:
            each_node(raise);
            break;
        case Statistic::min:
            each_node(lower);
            break;
        case Statistic::rms:
            each_node([](double& sum, double value) { sum += value * value; });
            break;
        case Statistic::max_all:
            each_point(raise);
            break;
        case Statistic::min_all:
            each_point(lower);
            break;
        case Statistic::final:
            break; // written from the stepper
        }
    }
}

// ---- files

/// Blocks of samples are gathered on rank 0, which puts the nodes in the order of the sensor.
void Recorder::write_nodes(const OutputFile& output, const Record& record, const Comm& team) const {
    const bool is_series = record.statistic == Statistic::series;
    const auto samples = is_series ? static_cast<std::size_t>(samples_) : std::size_t{1};
    const std::size_t nodes = order_.size();
    std::vector<h5::Id> datasets;
    std::vector<std::vector<hsize_t>> shapes;
    if (team.is_root()) {
        const auto add = [&](const OutputFile& to, const std::string& name,
                             std::vector<hsize_t> shape) {
            datasets.push_back(create_dataset(to, name, shape, Numbers::real));
            shapes.push_back(std::move(shape));
        };
        if (input_.cuboids.empty())
            add(output, record.name, {1, samples, nodes});
        else {
            const h5::Id group = h5::create_group(output.file, record.name);
            const OutputFile in_group{group.raw(), output.doubles, output.gzip_level};
            for (std::size_t c = 0; c < input_.cuboids.size(); ++c) {
                std::vector<hsize_t> shape;
                if (is_series) shape.push_back(samples);
                for (const std::size_t axis : {2u, 1u, 0u})
                    shape.push_back(static_cast<hsize_t>(input_.cuboids[c].count(axis)));
                add(in_group, std::to_string(c + 1), std::move(shape));
            }
        }
    }
    const std::size_t most =
        std::clamp<std::size_t>(most_values_at_once / std::max<std::size_t>(nodes, 1), 1, samples);
    for (std::size_t first = 0; first < samples; first += most) {
        const std::size_t count = std::min(most, samples - first);
        std::vector<double> mine;
        for (std::size_t i = 0; i < count_; ++i)
            for (std::size_t s = 0; s < count; ++s) {
                const double value = record.values[i * samples + first + s];
                mine.push_back(record.statistic == Statistic::rms
                                   ? std::sqrt(value / static_cast<double>(samples_))
                                   : value);
            }
        const std::vector<double> sorted = team.gather(mine);
        if (!team.is_root()) continue;
        std::vector<double> block(nodes * count); // [sample][node]
        for (std::size_t i = 0; i < nodes; ++i)
            for (std::size_t s = 0; s < count; ++s)
                block[s * nodes + order_[i]] = sorted[i * count + s];
        std::size_t first_node = 0;
        for (std::size_t d = 0; d < datasets.size(); ++d) {
            const std::vector<hsize_t>& shape = shapes[d];
            const bool is_list = input_.cuboids.empty();
            std::vector<hsize_t> start(shape.size(), 0), extent = shape;
            if (is_series) {
                start[is_list ? 1 : 0] = first;
                extent[is_list ? 1 : 0] = count;
            }
            hsize_t in_dataset = 1;
            for (std::size_t n = is_series && !is_list ? 1 : 0; n < shape.size(); ++n)
                in_dataset *= is_list && n == 1 ? 1 : shape[n];
            std::vector<double> part;
            for (std::size_t s = 0; s < count; ++s) {
                const auto from =
                    block.begin() + static_cast<std::ptrdiff_t>(s * nodes + first_node);
                part.insert(part.end(), from, from + static_cast<std::ptrdiff_t>(in_dataset));
            }
            first_node += in_dataset;
            const h5::Id in_file(H5Dget_space(datasets[d].raw()), H5Sclose, "find a dataspace"),
                memory(H5Screate_simple(static_cast<int>(extent.size()), extent.data(), nullptr),
                       H5Sclose, "create a dataspace");
            h5::check(H5Sselect_hyperslab(in_file.raw(), H5S_SELECT_SET, start.data(), nullptr,
                                          extent.data(), nullptr),
                      "select a block");
            h5::check(H5Dwrite(datasets[d].raw(), H5T_NATIVE_DOUBLE, memory.raw(), in_file.raw(),
                               H5P_DEFAULT, part.data()),
                      "write " + record.name);
        }
    }
}

void Recorder::write_grid(const OutputFile& output, const std::string& name,
                          const std::vector<double>& slab, const Comm& team) const {
    const std::vector<double> all = team.gather(slab);
    if (!team.is_root()) return;
    const std::ptrdiff_t nx = slabs_.nx(), ny = slabs_.ny(), nz = slabs_.nz();
    std::vector<double> turned(all.size());
    for (std::ptrdiff_t x = 0, at = 0; x < nx; ++x)
        for (std::ptrdiff_t y = 0; y < ny; ++y)
            for (std::ptrdiff_t z = 0; z < nz; ++z, ++at)
                turned[static_cast<std::size_t>((z * ny + y) * nx + x)] =
                    all[static_cast<std::size_t>(at)];
    const hsize_t shape[] = {static_cast<hsize_t>(nz), static_cast<hsize_t>(ny),
                             static_cast<hsize_t>(nx)};
    const h5::Id dataset = create_dataset(output, name, shape, Numbers::real);
    h5::check(
        H5Dwrite(dataset.raw(), H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, turned.data()),
        "write " + name);
}

template <class Real>
void Recorder::write(const OutputFile& output, const pstd::Stepper<Real>& stepper,
                     const Comm& team) const {
    for (const Record& record : records_) {
        if (record.statistic < Statistic::max_all)
            write_nodes(output, record, team);
        else
            write_grid(output, record.name,
                       record.statistic == Statistic::final
                           ? dense(slabs_, stepper, record.quantity)
                           : record.values,
                       team);
    }
}

DistributedRows Recorder::rows(const Record& record) const {
    if (record.statistic < Statistic::max_all)
        return {.total = static_cast<std::ptrdiff_t>(order_.size()),
                .start = static_cast<std::ptrdiff_t>(first_),
                .count = static_cast<std::ptrdiff_t>(count_),
                .row_length = record.statistic == Statistic::series ? samples_ : 1};
    return {.total = slabs_.nx(),
            .start = slabs_.x_start(),
            .count = slabs_.x_count(),
            .row_length = slabs_.ny() * slabs_.nz()};
}

void Recorder::save(StateWriter& state) const {
    for (const Record& record : records_)
        if (record.statistic != Statistic::final && rows(record).total > 0)
            state.put("record_" + record.name, rows(record), record.values.data());
}

void Recorder::restore(const StateReader& state) {
    for (Record& record : records_)
        if (record.statistic != Statistic::final && rows(record).total > 0)
            state.get("record_" + record.name, rows(record), record.values.data());
}

template void Recorder::add(const pstd::Stepper<double>&, const Comm&);
template void Recorder::add(const pstd::Stepper<float>&, const Comm&);
template void Recorder::write(const OutputFile&, const pstd::Stepper<double>&, const Comm&) const;
template void Recorder::write(const OutputFile&, const pstd::Stepper<float>&, const Comm&) const;

} // namespace shearwake::kwave
