// SPDX-License-Identifier: BSD-3-Clause
#include "studies/converge/refinement.hpp"

#include "base/error.hpp"
#include "engines/registry/make_engine.hpp"
#include "measures/surface_sums.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::converge {
namespace {

/// Measures are sums over cells, of which the edges of the focal disc cut some, and over frames by
/// the trapezoidal rule. Both are of second order, whatever that of the field is.
constexpr double order_of_sums = 2.0;

/// At the faces of bodies, cells contain the mean of two materials, which is of first order.
double order_in_spacing(const Case& c) {
    return varies_laterally(c.scene().medium)
               ? 1.0
               : engines::make_engine(c.solver)->order_in_spacing().value_or(order_of_sums);
}

Refinement half_the_spacing(const Case& c) {
    Refinement r{.name = "spacing", .change = "", .physics = c, .order = order_in_spacing(c)};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    d.spacing_m *= 0.5;
    // Without a sponge, a region ends half a cell before the edges of the domain.
    if (!c.measure.region_m.empty())
        r.physics.measure.region_m = measures::measured_outline(c.domain, c.measure);
    r.change = fmt::format("half the spacing, {:.4g} mm", 1e3 * d.spacing_m);
    return r;
}

Refinement twice_the_domain(const Case& c) {
    Refinement r{.name = "domain", .change = "", .physics = c, .order = std::nullopt};
    Domain& d = r.physics.domain;
    d.nx *= 2;
    d.ny *= 2;
    // The larger domain is measured where the original one is.
    r.physics.measure.region_m = measures::measured_outline(c.domain, c.measure);
    r.change = fmt::format("twice the domain, {:.4g} x {:.4g} mm", 1e3 * d.extent_x_m(),
                           1e3 * d.extent_y_m());
    return r;
}

Refinement half_the_step(const Case& c) {
    const engines::StepRefinement step = engines::make_engine(c.solver)->half_the_step(c);
    Refinement r{.name = "time",
                 .change = step.change + (step.change.empty() ? "" : ", and ") +
                           "half the frame interval",
                 .physics = c,
                 .ratio = step.ratio,
                 .order = step.order.value_or(order_of_sums)};
    r.physics.solver = step.options;
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
