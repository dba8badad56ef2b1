// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/case_step.hpp"

#include "engines/pstd/scheme/grid.hpp"
#include "parallel/agree.hpp"
#include "problem/case/edges.hpp"
#include "problem/medium/body.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake::pstd {
namespace {

constexpr double infinite = std::numeric_limits<double>::infinity();
/// Default step relative to the safe step, a margin for rounding errors and the factors of the
/// absorbing layer.
constexpr double share_of_safe = 0.95;

/// Minimum thickness of a layer in points, below which a note is reported.
constexpr double resolved_points = 5.0;

double k_squared(double spacing_m) {
    return 3.0 * std::pow(std::numbers::pi / spacing_m, 2);
}

/// The positive root of a dt^2 + b dt = 4, without cancellation.
double positive_root(double a, double b) {
    if (a == 0.0) return b == 0.0 ? infinite : 4.0 / b;
    return 8.0 / (b + std::sqrt(b * b + 16.0 * a));
}

std::string percent_known(double ratio) {
    // Measured for a focus at 7 m/s over tissue of c_s = 5 m/s, compared with c_p/c_s = 100.
    static constexpr double known[][2] = {{20.0, 1.4}, {10.0, 3.2}, {5.0, 7.6}, {3.0, 16.0}};
    for (const auto& [of, percent] : known)
        if (std::abs(ratio - of) < 1e-9)
            return fmt::format("{:.2g} % for a focus at 7 m/s over c_s = 5 m/s", percent);
    return "1.4 / 3.2 / 7.6 / 16 % at 20 / 10 / 5 / 3 times c_s for a focus at 7 m/s over "
           "c_s = 5 m/s";
}

} // namespace

double cubic_spacing_m(const Grid& grid) {
    double inverse_m2 = 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto points = static_cast<double>(grid.points[axis]);
        const double share = grid.points[axis] % 2 == 1 ? 1.0 - 1.0 / points : 1.0;
        inverse_m2 += std::pow(share / grid.spacing_m[axis], 2);
    }
    return std::sqrt(3.0 / inverse_m2);
}

double largest_step_s(const NodeMaterial& m, double spacing_m) {
    if (m.empty) return infinite;
    const double k2 = k_squared(spacing_m);
    const auto limit_s = [&](double c_m_s, double viscosity_Pa_s) {
        return positive_root(c_m_s * c_m_s * k2, 2.0 * k2 * viscosity_Pa_s / m.density_kg_m3);
    };
    return std::min(limit_s(m.c_p_m_s, m.chi_Pa_s + 2.0 * m.eta_Pa_s),
                    limit_s(m.c_s_m_s, m.eta_Pa_s));
}

void Extremes::add(const NodeMaterial& m, double spacing_m) {
    if (m.empty) return;
    p_modulus_Pa = std::max(p_modulus_Pa, m.lambda_Pa() + 2.0 * m.mu_Pa());
    p_viscosity_Pa_s = std::max(p_viscosity_Pa_s, m.chi_Pa_s + 2.0 * m.eta_Pa_s);
    least_density_kg_m3 = least_density_kg_m3 == 0.0
                              ? m.density_kg_m3
                              : std::min(least_density_kg_m3, m.density_kg_m3);
    const double own_s = largest_step_s(m, spacing_m);
    alone_s = alone_s == 0.0 ? own_s : std::min(alone_s, own_s);
}

void Extremes::add(double lambda_Pa, double mu_Pa, double density_kg_m3) {
    p_modulus_Pa = std::max(p_modulus_Pa, lambda_Pa + 2.0 * mu_Pa);
    least_density_kg_m3 = std::min(least_density_kg_m3, density_kg_m3);
}

double safe_step_s(const Extremes& e, double spacing_m) {
    const double k2 = k_squared(spacing_m);
    return positive_root(e.p_modulus_Pa / e.least_density_kg_m3 * k2,
                         2.0 * k2 * e.p_viscosity_Pa_s / e.least_density_kg_m3);
}

namespace {

/// Where the medium varies along x and y: within the bounds of bodies and the depths of a map.
class Varied {
public:
    explicit Varied(const Case& c) : c_(c), half_m_(0.5 * c.domain.spacing_m) {
        for (const Body& body : c.scene.medium.bodies)
            bodies_.push_back(bounds(body));
        if (c.scene.medium.map) map_ = depths(*c.scene.medium.map);
    }
    /// Whether the cells of a column of the domain may differ from others at their depths.
    bool column(std::ptrdiff_t i, std::ptrdiff_t j) const {
        return map_.top_m <= map_.bottom_m ||
               std::any_of(bodies_.begin(), bodies_.end(), [&](const Bounds& b) {
                   return overlap(c_.domain.x_m(i), b.low_m.x, b.high_m.x) &&
                          overlap(c_.domain.y_m(j), b.low_m.y, b.high_m.y);
               });
    }
    /// Whether a cell of the domain may differ from others at its depth.
    bool operator()(std::ptrdiff_t i, std::ptrdiff_t j, double z_m) const {
        if (overlap(z_m, map_.top_m, map_.bottom_m)) return true;
        return std::any_of(bodies_.begin(), bodies_.end(), [&](const Bounds& b) {
            return overlap(z_m, b.low_m.z, b.high_m.z) &&
                   overlap(c_.domain.x_m(i), b.low_m.x, b.high_m.x) &&
                   overlap(c_.domain.y_m(j), b.low_m.y, b.high_m.y);
        });
    }

private:
    bool overlap(double centre_m, double low_m, double high_m) const {
        return centre_m + half_m_ >= low_m && centre_m - half_m_ <= high_m;
    }
    const Case& c_;
    double half_m_;
    std::vector<Bounds> bodies_;
    DepthRange map_{infinite, -infinite};
};

/// Extremes of the nodes in `x_count` rows from `x_start`. Of equal nodes at a depth one is
/// evaluated.
Extremes extremes_of_rows(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          std::ptrdiff_t x_start, std::ptrdiff_t x_count,
                          engines::ChoiceLimit limit) {
    Extremes e;
    const bool varies = varies_laterally(c.scene.medium);
    const std::ptrdiff_t nx = varies ? x_count : std::min<std::ptrdiff_t>(1, x_count),
                         ny = varies ? grid.points[1] : 1;
    const Varied varied(c);
    const StaggeredMaterial between = staggered_material(c, options, grid);
    std::vector<char> done(static_cast<std::size_t>(grid.points[2]), 0); // the layers at a depth
    std::ptrdiff_t left = grid.points[2];                                // of them
    for (std::ptrdiff_t x = 0; x < nx; ++x) {
        limit.check();
        for (std::ptrdiff_t y = 0; y < ny; ++y) {
            const Node column = grid.domain_point(c.domain, {x_start + x, y, 0});
            if (left == 0 && !varied.column(column[0], column[1])) continue;
            limit.check();
            for (std::ptrdiff_t z = 0; z < grid.points[2]; ++z) {
                const bool own = varied(column[0], column[1], grid.node_depth_m(z));
                if (!own) {
                    char& known = done[static_cast<std::size_t>(z)];
                    if (known != 0) continue;
                    known = 1;
                    --left;
                }
                const Node node{x_start + x, y, z};
                const NodeMaterial m = material_at(c, options, grid, node);
                e.add(m, c.domain.spacing_m);
                const bool inside = own || grid.node_depth_m(z) > 0.0;
                for (std::size_t i = 0; i < 3 && inside && !m.empty; ++i)
                    e.add(m.lambda_Pa(), between.mu_Pa[i](node), between.density_kg_m3[i](node));
            }
        }
    }
    return e;
}

} // namespace

Extremes extremes_of_grid(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          engines::ChoiceLimit limit) {
    return extremes_of_rows(c, options, grid, 0, grid.points[0], limit);
}

Extremes extremes_of_grid(const Case& c, const PstdOptions& options, const CaseGrid& grid,
                          const Comm& team) {
    const Slabs slabs = slabs_of({grid.points, {}, 0.0}, team.size(), team.rank());
    Extremes e;
    together(team,
             [&] { e = extremes_of_rows(c, options, grid, slabs.x_start(), slabs.x_count(), {}); });
    e.p_modulus_Pa = team.max(e.p_modulus_Pa);
    e.p_viscosity_Pa_s = team.max(e.p_viscosity_Pa_s);
    e.least_density_kg_m3 =
        team.min(e.least_density_kg_m3 > 0.0 ? e.least_density_kg_m3 : infinite);
    e.alone_s = team.min(e.alone_s > 0.0 ? e.alone_s : infinite);
    return e;
}

StepChoice choose_step(const Case& c, const PstdOptions& options, const Extremes& extremes) {
    StepChoice choice;
    choice.safe_s = safe_step_s(extremes, c.domain.spacing_m);
    choice.alone_s = extremes.alone_s;
    const double wanted_s = options.time_step_s.value_or(share_of_safe * choice.safe_s);
    choice.refused = wanted_s > choice.alone_s;
    choice.per_frame = static_cast<std::ptrdiff_t>(std::ceil(c.time.interval_s / wanted_s - 1e-9));
    choice.step_s = c.time.interval_s / static_cast<double>(choice.per_frame);
    return choice;
}

std::string refusal(const PstdOptions& options, const StepChoice& choice) {
    return fmt::format(
        "solver.pstd.time_step_us = {:.6g} is unstable on this grid: steps above "
        "{:.6g} are unstable, steps up to {:.6g} are stable; reduce the step or omit the key",
        1e6 * options.time_step_s.value_or(choice.step_s), 1e6 * choice.alone_s,
        1e6 * choice.safe_s);
}

std::vector<engines::Choice> step_choices(const PstdOptions& options, const StepChoice& step) {
    std::vector<engines::Choice> notes;
    if (step.refused)
        notes.push_back({"solver.pstd.time_step_us", refusal(options, step)});
    else
        notes.push_back({"", fmt::format("pstd uses steps of {:.4g} us, {} per frame; steps up to "
                                         "{:.4g} us are stable",
                                         1e6 * step.step_s, step.per_frame, 1e6 * step.safe_s)});
    if (!step.refused && step.step_s > step.safe_s)
        notes.push_back(
            {"solver.pstd.time_step_us",
             fmt::format("the time step exceeds the safe limit of {:.4g} us; the scheme "
                         "is certainly unstable above {:.4g} us",
                         1e6 * step.safe_s, 1e6 * step.alone_s)});
    return notes;
}

std::vector<engines::Choice> case_choices(const Case& c, const PstdOptions& options) {
    std::vector<engines::Choice> notes;
    for (const Layer& layer : c.scene.medium.layers)
        if (layer.c_p_m_s > options.c_p_over_c_s * layer.c_s_m_s * (1.0 + 1e-12))
            notes.push_back(
                {"solver.pstd.c_p_over_c_s",
                 fmt::format("c_p of layer \"{}\" is capped at {:.4g} m/s, {:.4g} times c_s, "
                             "instead of {:.4g} "
                             "m/s (solver.pstd.c_p_over_c_s); error of the surface field: {}",
                             layer.name, options.c_p_over_c_s * layer.c_s_m_s, options.c_p_over_c_s,
                             layer.c_p_m_s, percent_known(options.c_p_over_c_s))});
    if (options.top == PstdTop::nothing && options.load == PstdLoad::traction)
        notes.push_back({"domain.spacing_mm",
                         fmt::format("the free surface of pstd causes an error of about 4 / 2 / 1 "
                                     "% of the surface field "
                                     "at 3 / 4 / 6 points per focus width; this case has {:.3g}",
                                     fwhm_m(c.scene.load.footprint) / c.domain.spacing_m)});
    if (options.top == PstdTop::fluid)
        notes.push_back({"domain.spacing_mm",
                         "below a fluid the observed error of pstd is 4 to 7 % at 9 to 3 points "
                         "per focus width"});
    for (const Layer& layer : c.scene.medium.layers)
        if (layer.thickness_m > 0.0 && layer.thickness_m < resolved_points * c.domain.spacing_m)
            notes.push_back(
                {"domain.spacing_mm",
                 fmt::format(
                     "layer \"{}\" is {:.2g} points of pstd's grid thick; for a film of two "
                     "points, "
                     "nine times as stiff as the medium below, the observed error of the surface "
                     "field is 15 %",
                     layer.name, layer.thickness_m / c.domain.spacing_m)});
    if (c.domain.sponge_m > 0.0 && options.edges == PstdEdges::periodic)
        notes.push_back(
            {"",
             fmt::format("the margin of {:.3g} mm is used as pstd's absorbing layer of {} points",
                         1e3 * c.domain.sponge_m,
                         std::lround(c.domain.sponge_m / c.domain.spacing_m))});
    return notes;
}

std::vector<engines::Choice> choices(const Case& c, const PstdOptions& options,
                                     const StepChoice& step) {
    auto all = step_choices(options, step);
    const auto more = case_choices(c, options);
    all.insert(all.end(), more.begin(), more.end());
    return all;
}

} // namespace shearwake::pstd
