// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/recorder.hpp"

#include "fft/fftw_real.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <fftw3.h>
#include <limits>
#include <numbers>
#include <numeric>

namespace shearwake::pstd {
namespace {

/// The quantities of the scheme in the order of the recorder.
constexpr std::array<Quantity, Recorder::moved> scheme_quantities = {pressure_quantity, Field::ux,
                                                                     Field::uy, Field::uz};

} // namespace

/// The compressional part of the velocities, u_p = k (k.u)/k^2 in wave number space, on rank 0.
class SplitFields {
public:
    explicit SplitFields(const Slabs& slabs) : slabs_(slabs) {}

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
                    const Node i{x, y, z};
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
    Slabs slabs_;
};

/// Whether a record of points, or one that is computed from it, has one of these quantities.
bool Recorder::needs(std::size_t first, std::size_t count) const {
    return std::any_of(records_.begin(), records_.end(), [&](const Record& record) {
        return !record.is_grid() && record.quantity >= first && record.quantity < first + count;
    });
}

Recorder::Recorder(const SensorPoints& points, const Scheme& scheme,
                   const std::set<std::string>& records, std::ptrdiff_t first_step,
                   std::ptrdiff_t steps)
    : points_(points), scheme_(scheme), slabs_(scheme.slabs()), first_step_(first_step),
      samples_(steps - first_step + 1), records_(records_of(records, slabs_.grid)),
      order_(points.nodes.size()), now_(quantity_count) {
    std::iota(order_.begin(), order_.end(), std::size_t{0});
    const auto x_of = [&](std::size_t node) { return points.nodes[node][0]; };
    std::stable_sort(order_.begin(), order_.end(),
                     [&](std::size_t a, std::size_t b) { return x_of(a) < x_of(b); });
    SensorNodes nodes;
    for (std::size_t i = 0; i < order_.size(); ++i) {
        if (x_of(order_[i]) < slabs_.x_start()) first_ = i + 1;
        if (slabs_.has(x_of(order_[i]))) ++count_;
        nodes.nodes.push_back(points.nodes[order_[i]]);
    }
    nodes.first = first_;
    nodes.count = count_;
    sensor_ = scheme.sensor(nodes);
    if (points.weights.empty()) {
        point_order_ = order_;
        first_point_ = first_;
        count_points_ = count_;
    } else {
        point_order_.resize(points.size());
        std::iota(point_order_.begin(), point_order_.end(), std::size_t{0});
        const auto start = [&](int rank) {
            return points.size() * static_cast<std::size_t>(rank) /
                   static_cast<std::size_t>(slabs_.ranks);
        };
        first_point_ = start(slabs_.rank);
        count_points_ = start(slabs_.rank + 1) - first_point_;
    }
    constexpr double infinite = std::numeric_limits<double>::infinity();
    for (Record& record : records_) {
        const bool is_max = record.statistic == Statistic::max,
                   is_min = record.statistic == Statistic::min;
        const auto samples = static_cast<std::size_t>(record.is_series() ? samples_ : 1);
        record.values.assign(record.is_grid() ? 0 : count_points_ * samples, is_max   ? -infinite
                                                                             : is_min ? infinite
                                                                                      : 0.0);
        if (record.is_grid() && record.statistic != Statistic::final)
            record.tally =
                scheme.tally({.quantity = scheme_quantities[record.quantity],
                              .kind = record.statistic == Statistic::max_all ? Tally::Kind::max
                                                                             : Tally::Kind::min,
                              .planes = slabs_.nz()});
    }
    if (needs(split_p, 6)) split_ = std::make_unique<SplitFields>(slabs_);
    if (needs(moved, 3) || split_) make_moves();
}

/// The half cell towards lower indices, without the Nyquist frequency: a sum over the line.
void Recorder::make_moves() {
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
void Recorder::move_to_nodes(std::size_t axis, const Comm& team) {
    std::vector<double> sums = sensor_->line_sums(static_cast<Field>(axis), move_[axis]);
    if (axis > 0) {
        now_[moved + axis] = std::move(sums);
        return;
    }
    team.sum(std::span<double>(sums));
    const auto mine = sums.begin() + static_cast<std::ptrdiff_t>(first_);
    now_[moved].assign(mine, mine + static_cast<std::ptrdiff_t>(count_));
}

void Recorder::split_velocities(const Comm& team) {
    std::array<std::vector<double>, 3> u;
    for (std::size_t a = 0; a < 3; ++a)
        u[a] = team.gather(scheme_.dense(static_cast<Field>(a)));
    if (team.is_root()) split_->project(u);
    for (std::size_t a = 0; a < 3; ++a) {
        std::vector<double> gathered(order_.size());
        for (std::size_t i = 0; i < gathered.size() && team.is_root(); ++i) {
            const Node& n = points_.nodes[order_[i]];
            gathered[i] =
                u[a][static_cast<std::size_t>((n[0] * slabs_.ny() + n[1]) * slabs_.nz() + n[2])];
        }
        team.broadcast(gathered);
        now_[split_p + a].assign(gathered.begin() + static_cast<std::ptrdiff_t>(first_),
                                 gathered.begin() + static_cast<std::ptrdiff_t>(first_ + count_));
        now_[split_s + a].resize(count_);
        for (std::size_t i = 0; i < count_; ++i)
            now_[split_s + a][i] = now_[moved + a][i] - now_[split_p + a][i];
    }
}

void Recorder::find_values(const Comm& team) {
    std::vector<std::size_t> needed;
    std::vector<Quantity> quantities;
    for (std::size_t q = pressure; q < moved; ++q) {
        if (!needs(q, 1)) continue;
        needed.push_back(q);
        quantities.push_back(scheme_quantities[q]);
    }
    auto values = sensor_->values(quantities);
    for (std::size_t i = 0; i < needed.size(); ++i)
        now_[needed[i]] = std::move(values[i]);
    for (std::size_t axis = 0; axis < 3 && !move_[0].empty(); ++axis)
        move_to_nodes(axis, team);
    if (split_) split_velocities(team);
    if (!points_.weights.empty()) interpolate(team);
}

/// Replaces the values of nodes by those of points. The nodes of a point may lie on several ranks.
void Recorder::interpolate(const Comm& team) {
    std::vector<double> sums(points_.size());
    for (std::size_t q = 0; q < intensity; ++q) {
        if (!needs(q, 1)) continue;
        std::fill(sums.begin(), sums.end(), 0.0);
        for (std::size_t i = 0; i < count_; ++i) {
            const std::size_t node = order_[first_ + i];
            sums[node / points_.nodes_of_a_point] += points_.weights[node] * now_[q][i];
        }
        team.sum(std::span<double>(sums));
        const auto mine = sums.begin() + static_cast<std::ptrdiff_t>(first_point_);
        now_[q].assign(mine, mine + static_cast<std::ptrdiff_t>(count_points_));
    }
}

void Recorder::add(const Comm& team) {
    add_found();
    const std::ptrdiff_t sample = scheme_.steps() - first_step_;
    if (sample < 0 || sample >= samples_) return;
    for (Record& record : records_)
        if (record.tally) record.tally->add();
    find_values(team);
    found_ = sample;
}

/// Adds the values of the last sample to the records of points.
void Recorder::add_found() {
    if (!found_) return;
    const auto sample = static_cast<std::size_t>(*found_),
               samples = static_cast<std::size_t>(samples_);
    found_.reset();
    for (Record& record : records_) {
        if (record.quantity >= intensity) continue; // see finish
        const std::vector<double>& now = now_[record.quantity];
        const auto each_point = [&](const auto& change) {
            for (std::size_t i = 0; i < count_points_; ++i)
                change(record.values[i], now[i]);
        };
        switch (record.statistic) {
        case Statistic::series:
            for (std::size_t i = 0; i < count_points_; ++i)
                record.values[i * samples + sample] = now[i];
            break;
        case Statistic::max:
            each_point([](double& most, double value) { most = std::max(most, value); });
            break;
        case Statistic::min:
            each_point([](double& least, double value) { least = std::min(least, value); });
            break;
        case Statistic::rms:
            each_point([](double& sum, double value) { sum += value * value; });
            break;
        case Statistic::max_all:
        case Statistic::min_all: // tallies
        case Statistic::mean:    // of intensities only
        case Statistic::final:
            break; // from the scheme
        }
    }
}

std::vector<double> Recorder::grid_of(const Record& record, const Comm& team) const {
    return team.gather(record.tally ? record.tally->values()
                                    : scheme_.dense(scheme_quantities[record.quantity]));
}

} // namespace shearwake::pstd
