// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/case_load.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace shearwake::pstd {
namespace {

/// Cutoff of a Gaussian in standard deviations, where it is 1.5e-8 of its peak.
constexpr double reach_sigmas = 6.0;
/// Minimum share of the peak at which the displacement of the skin is prescribed.
constexpr double moved_share = 1e-3;
/// Number of empty nodes with the full stress of the load, and of those over which it decreases to
/// 0.
constexpr std::ptrdiff_t flat_nodes = 4, fading_nodes = 8;

/// The foci at the points of the domain: unit peaks, divided by the number of foci, times the
/// amplitude.
class MovingGaussians {
public:
    MovingGaussians(const Case& c)
        : load_(c.scene.load), domain_(c.domain),
          off_s_(off_time_s(c.scene.load.modulation.trajectory)),
          reach_m_(reach_sigmas * fwhm_m(c.scene.load.footprint) /
                   (2.0 * std::sqrt(2.0 * std::log(2.0)))) {}

    /// Calls add(i, j, value) for the points near a focus at time t, in units of the peak.
    template <class Add>
    void each(double t_s, const Add& add) {
        if (t_s > off_s_) return;
        const auto places = foci(load_.modulation, t_s);
        add_each(places, amplitude(load_, t_s) / static_cast<double>(places.size()), add);
    }

    /// The same with an amplitude of 1 for each focus.
    template <class Add>
    void each_focus(double t_s, const Add& add) {
        if (t_s <= off_s_) add_each(foci(load_.modulation, t_s), 1.0, add);
    }

private:
    template <class Add>
    void add_each(const std::vector<Vec2>& places, double scale, const Add& add) {
        if (scale == 0.0) return;
        for (const Vec2& focus : places) {
            const Range x = near(focus.x, domain_.nx), y = near(focus.y, domain_.ny);
            along_y_.clear();
            for (std::ptrdiff_t j = y.begin; j < y.end; ++j)
                along_y_.push_back(pressure(load_.footprint, 0.0, domain_.y_m(j) - focus.y));
            for (std::ptrdiff_t i = x.begin; i < x.end; ++i) {
                const double at_x =
                    scale * pressure(load_.footprint, domain_.x_m(i) - focus.x, 0.0);
                for (std::ptrdiff_t j = y.begin; j < y.end; ++j)
                    add(i, j, at_x * along_y_[static_cast<std::size_t>(j - y.begin)]);
            }
        }
    }

    struct Range {
        std::ptrdiff_t begin, end;
    };
    Range near(double focus_m, std::ptrdiff_t points) const {
        const auto index = [&](double x_m) { // index of the point at or above x_m
            return std::clamp<std::ptrdiff_t>(
                static_cast<std::ptrdiff_t>(std::ceil(x_m / domain_.spacing_m)) + points / 2, 0,
                points);
        };
        return {index(focus_m - reach_m_), index(focus_m + reach_m_)};
    }
    Load load_;
    Domain domain_;
    double off_s_, reach_m_;
    std::vector<double> along_y_;
};

/// Values of a source whose nodes are the `planes` of each point of the domain, in this order.
struct Columns {
    std::ptrdiff_t ny, planes;

    /// Adds the value times the weight of each plane; `which` is a contiguous range.
    void add(std::span<const std::size_t> which, std::span<double> values, std::ptrdiff_t i,
             std::ptrdiff_t j, double value, std::span<const double> weights) const {
        const auto first = static_cast<std::ptrdiff_t>(which.front());
        const std::ptrdiff_t at = (i * ny + j) * planes - first;
        if (at < 0 || at >= std::ssize(values)) return; // belongs to another rank
        for (std::size_t k = 0; k < weights.size(); ++k)
            values[static_cast<std::size_t>(at) + k] += value * weights[k];
    }
};

Source stress_above(const Case& c, const CaseGrid& grid, double step_s) {
    Source source{
        .field = Field::szz, .mode = SourceMode::dirichlet, .scaling = SourceScaling::none};
    std::vector<double> weights;
    for (std::ptrdiff_t k = flat_nodes + fading_nodes - 1; k >= 1; --k) // downward
        weights.push_back(k <= flat_nodes ? 1.0
                                          : std::pow(std::cos(0.5 * std::numbers::pi *
                                                              static_cast<double>(k - flat_nodes) /
                                                              static_cast<double>(fading_nodes)),
                                                     2));
    const Columns columns{c.domain.ny, std::ssize(weights)};
    source.nodes.reserve(static_cast<std::size_t>(c.domain.nx * c.domain.ny * columns.planes));
    for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
            for (std::ptrdiff_t k = 0; k < columns.planes; ++k)
                source.nodes.push_back(
                    {grid.first_x + i, grid.first_y + j, grid.surface - columns.planes + k});
    // After step n + 1 stresses belong to (n + 1) dt. At t = 0 there was no stress yet: the second
    // step compensates for the first one, in which the load acts on the velocities for half a step
    // only.
    source.values = [=, load = MovingGaussians(c), peak_Pa = c.scene.load.peak_Pa](
                        std::ptrdiff_t sample, std::span<const std::size_t> which,
                        std::span<double> values) mutable {
        std::fill(values.begin(), values.end(), 0.0);
        const auto press = [&](double t_s, double share) {
            load.each(t_s, [&](std::ptrdiff_t i, std::ptrdiff_t j, double value) {
                columns.add(which, values, i, j, -share * peak_Pa * value, weights);
            });
        };
        press(static_cast<double>(sample + 1) * step_s, 1.0);
        if (sample == 0) press(0.0, 0.5);
    };
    return source;
}

Source force_sheet(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s) {
    Source source{.field = Field::uz, .scaling = SourceScaling::none, .in_rates = true};
    std::vector<double> per_Pa; // velocity per Pa
    const Grid counts{grid.points, {}, step_s};
    const MaterialOfNode material = [&](Node n) { return material_at(c, options, grid, n); };
    for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i) {
        for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
            const Node node{grid.first_x + i, grid.first_y + j, grid.surface - 1};
            source.nodes.push_back(node);
            per_Pa.push_back(velocity_of_force_m_s(1.0 / grid.spacing_m, step_s,
                                                   density_between(counts, material, node, 2)));
        }
    }
    const Columns columns{c.domain.ny, 1};
    source.values = [=, load = MovingGaussians(c), peak_Pa = c.scene.load.peak_Pa](
                        std::ptrdiff_t sample, std::span<const std::size_t> which,
                        std::span<double> values) mutable {
        std::fill(values.begin(), values.end(), 0.0);
        const double scale = (sample == 0 ? 0.5 : 1.0) * peak_Pa;
        load.each(static_cast<double>(sample) * step_s,
                  [&](std::ptrdiff_t i, std::ptrdiff_t j, double value) {
                      const auto at = static_cast<std::size_t>(i * columns.ny + j);
                      columns.add(which, values, i, j, scale * per_Pa[at] * value, std::array{1.0});
                  });
    };
    return source;
}

/// Values of the source of moved_skin().
class SkinMotion {
public:
    /// `number`: index of the node at each point of the domain, or -1.
    SkinMotion(const Case& c, const PstdOptions& options, double step_s,
               std::vector<std::ptrdiff_t> number)
        : load_(c), number_(std::move(number)), ny_(c.domain.ny), step_s_(step_s),
          prescribed_(options.prescribed), kind_(options.load),
          peak_m_s_(kind_ == PstdLoad::velocity ? options.velocity_m_s
                                                : options.displacement_m / step_s) {}

    void operator()(std::ptrdiff_t sample, std::span<const std::size_t> which,
                    std::span<double> values) {
        constexpr double is_free = not_a_number;
        const bool on_path = prescribed_ == PstdPrescribed::path;
        std::fill(values.begin(), values.end(), on_path ? 0.0 : is_free);
        first_ = static_cast<std::ptrdiff_t>(which.front());
        const double t_s = static_cast<double>(sample) * step_s_;
        if (!on_path)
            load_.each_focus(
                t_s + 0.5 * step_s_, [&](std::ptrdiff_t i, std::ptrdiff_t j, double share) {
                    double* value = share > moved_share ? node_value(i, j, values) : nullptr;
                    if (value) *value = 0.0;
                });
        if (kind_ == PstdLoad::velocity) {
            add(t_s + 0.5 * step_s_, peak_m_s_, values);
            return;
        }
        // The difference quotient over the step, so that the sum of the steps equals the
        // displacement.
        add(t_s + step_s_, peak_m_s_, values);
        if (sample > 0) add(t_s, -peak_m_s_, values); // starts from rest
    }

private:
    /// The value of a point, or null if it is not a node of this rank.
    double* node_value(std::ptrdiff_t i, std::ptrdiff_t j, std::span<double> values) const {
        const std::ptrdiff_t n = number_[static_cast<std::size_t>(i * ny_ + j)] - first_;
        return n >= 0 && n < std::ssize(values) ? &values[static_cast<std::size_t>(n)] : nullptr;
    }
    void add(double t_s, double scale, std::span<double> values) {
        load_.each(t_s, [&](std::ptrdiff_t i, std::ptrdiff_t j, double share) {
            if (double* value = node_value(i, j, values)) *value += scale * share;
        });
    }

    MovingGaussians load_;
    std::vector<std::ptrdiff_t> number_;
    std::ptrdiff_t ny_, first_ = 0;
    double step_s_;
    PstdPrescribed prescribed_;
    PstdLoad kind_;
    double peak_m_s_;
};

Source moved_skin(const Case& c, const CaseGrid& grid, const PstdOptions& options, double step_s) {
    Source source{.field = Field::uz,
                  .mode = SourceMode::total,
                  .scaling = SourceScaling::none,
                  .in_rates = true};
    const auto ny = c.domain.ny;
    std::vector<char> moved(static_cast<std::size_t>(c.domain.nx * ny), 0);
    MovingGaussians scan(c);
    for (double n = 0.0; n * step_s <= c.time.duration_s(); ++n)
        scan.each(n * step_s, [&](std::ptrdiff_t i, std::ptrdiff_t j, double value) {
            if (value > moved_share) moved[static_cast<std::size_t>(i * ny + j)] = 1;
        });
    std::vector<std::ptrdiff_t> number(moved.size(), -1); // index of the node
    for (std::ptrdiff_t at = 0; at < std::ssize(moved); ++at) {
        if (moved[static_cast<std::size_t>(at)] == 0) continue;
        number[static_cast<std::size_t>(at)] = std::ssize(source.nodes);
        source.nodes.push_back({grid.first_x + at / ny, grid.first_y + at % ny, grid.surface - 1});
    }
    source.values = SkinMotion(c, options, step_s, std::move(number));
    return source;
}

} // namespace

Source load_source(const Case& c, const PstdOptions& options, const CaseGrid& grid, double step_s) {
    if (options.load != PstdLoad::traction) return moved_skin(c, grid, options, step_s);
    if (options.top == PstdTop::nothing) return stress_above(c, grid, step_s);
    return force_sheet(c, options, grid, step_s);
}

double most_source_nodes(const Case& c, const PstdOptions& options) {
    const bool in_air = options.load == PstdLoad::traction && options.top == PstdTop::nothing;
    return static_cast<double>(c.domain.nx * c.domain.ny *
                               (in_air ? flat_nodes + fading_nodes - 1 : 1));
}

} // namespace shearwake::pstd
