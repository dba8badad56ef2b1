// SPDX-License-Identifier: BSD-3-Clause
#include "converge/refinement.hpp"

#include "base/error.hpp"
#include "base/overloaded.hpp"
#include "engines/registry/make_engine.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::converge {
namespace {

bool is_uneven(const Case& c) {
    return !c.scene().medium.bodies.empty() || c.scene().medium.map;
}

/// Fourier series in x and y converge faster than any power of the spacing in layers. At the faces
/// of bodies, cells contain the mean of two materials, which is of first order. The free surface
/// of pstd is of second order (4, 2 and 1 % at 3, 4 and 6 points per FWHM).
std::optional<double> order_in_spacing(const Case& c) {
    if (is_uneven(c)) return 1.0;
    const auto* pstd = std::get_if<PstdOptions>(&c.solver);
    return pstd ? std::optional(2.0) : std::nullopt;
}

Refinement half_the_spacing(const Case& c) {
    Refinement r{.name = "spacing", .change = "", .physics = c, .order = order_in_spacing(c)};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    d.spacing_m *= 0.5;
    r.change = fmt::format("half the spacing, {:.4g} mm", 1e3 * d.spacing_m);
    return r;
}

Refinement twice_the_domain(const Case& c) {
    Refinement r{.name = "domain", .change = "", .physics = c, .order = std::nullopt};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    r.change = fmt::format("twice the domain, {:.4g} x {:.4g} mm", 1e3 * d.extent_x_m(),
                           1e3 * d.extent_y_m());
    return r;
}

/// Both time-stepping engines are of second order in the step.
constexpr double order_in_time = 2.0;
/// The smallest `accuracy` that the engine `spectral` accepts.
constexpr double least_accuracy = 1e-4;

/// An engine without an own rule.
template <class Options>
void refine(Options&, Refinement& r) {
    r.change = "half the frame interval";
}

void refine(LayeredOptions& o, Refinement& r) {
    // The solution is exact at the frames. Its interpolation has a tolerance.
    if (o.time_step_s) *o.time_step_s *= 0.5;
    o.interpolation_tolerance = std::max(0.25 * o.interpolation_tolerance, 1e-12);
    r.change = "half the frame interval, a quarter of the interpolation tolerance";
}

void refine(SpectralOptions& o, Refinement& r) {
    r.order = order_in_time;
    if (o.time_step_s || o.accuracy < 2.0 * least_accuracy) {
        const double step_s = o.time_step_s.value_or(
            engines::make_engine(r.physics.solver)->probed_step_s(r.physics));
        o.time_step_s = 0.5 * step_s;
        r.change = fmt::format("half the time step, {:.4g} us, and half the frame interval",
                               0.5e6 * step_s);
        return;
    }
    const double before = o.accuracy;
    o.accuracy = std::max(0.25 * before, least_accuracy);
    r.ratio = std::sqrt(before / o.accuracy); // the error is proportional to the step squared
    r.change = fmt::format("{:.3g} of the tolerance (accuracy {:.3g}), half the frame interval",
                           o.accuracy / before, o.accuracy);
}

void refine(PstdOptions& o, Refinement& r) {
    const double step_s =
        o.time_step_s.value_or(engines::make_engine(r.physics.solver)->probed_step_s(r.physics));
    o.time_step_s = 0.5 * step_s;
    r.order = order_in_time;
    r.change =
        fmt::format("half the time step, {:.4g} us, and half the frame interval", 0.5e6 * step_s);
}

Refinement half_the_step(const Case& c) {
    Refinement r{.name = "time", .change = "", .physics = c, .order = std::nullopt};
    SolverOptions solver = c.solver;
    std::visit([&](auto& options) { refine(options, r); }, solver);
    r.physics.solver = solver;
    r.physics.time.frames *= 2;
    r.physics.time.interval_s *= 0.5;
    return r;
}

} // namespace

Case without_fields(Case c) {
    c.record.frames = false;
    c.record.volumes_s.clear();
    c.record.volume_fields.clear();
    return c;
}

std::vector<Refinement> refinements(const Case& c) {
    if (c.study())
        throw UsageError("a k-Wave study has a fixed grid and time step: export it from k-Wave "
                         "with finer ones, and compare both with shearwake compare");
    const Case base = without_fields(c);
    return {half_the_spacing(base), half_the_step(base), twice_the_domain(base)};
}

double estimated_error(double change, const Refinement& refinement) {
    if (!refinement.order) return std::abs(change);
    const double power = std::pow(refinement.ratio, *refinement.order);
    return std::abs(change) * power / (power - 1.0);
}

} // namespace shearwake::converge
