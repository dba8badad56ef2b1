// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/rigid_choice.hpp"

#include "engines/spectral/bodies/lump_markers.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace shearwake::spectral {

namespace {

/// Smallest width of a rigid body in grid spacings: markers stand half a spacing inside its faces.
constexpr double least_spacings = 2.0;
/// Width in grid spacings below which a sphere is less accurate if it is rigid than if it is
/// elastic, whatever its stiffness: docs/explanation/engine-spectral.md, "Rigid bodies".
constexpr double accurate_spacings = 6.0;
/// Bodies that share less than 1/64 of each side of the box that contains both are not recognised.
constexpr int overlap_halvings = 6;
/// Markers above which a lump is treated as rigid only on request: their matrix then needs 300 MB,
/// and a step takes longer than one with an elastic body.
constexpr std::size_t most_markers = 2000;
/// Limit of squares_around() for all lumps: their matrix then needs about 200 GB on all ranks.
constexpr double most_squares = 1e5;

/// Largest error of the stress within near_spacings of a body, in % of the largest stress around
/// it: docs/explanation/engine-spectral.md, "Stress around rigid bodies".
double stress_error_percent(const Body& body) {
    constexpr double curved_percent = 26.0, edged_percent = 47.0;
    return std::visit(overloaded{[](const Ellipsoid&) { return curved_percent; },
                                 [](const Cylinder& c) {
                                     return c.is_endless() ? curved_percent : edged_percent;
                                 },
                                 [](const Box&) { return edged_percent; }},
                      body.shape);
}

bool spans(double centre_m, double size_m, double extent_m) {
    const double most_m = 0.5 * extent_m * (1.0 - 1e-9);
    return centre_m - 0.5 * size_m <= -most_m && centre_m + 0.5 * size_m >= most_m;
}

/// Without periodic images.
bool shares_volume_here(const Body& a, const Body& b, const Domain& domain) {
    const Bounds one = bounds(a), other = bounds(b);
    // Infinite bodies are those of the domain.
    const double far_x_m = domain.extent_x_m(), far_y_m = domain.extent_y_m();
    const Vec3 low{std::max({one.low_m.x, other.low_m.x, -far_x_m}),
                   std::max({one.low_m.y, other.low_m.y, -far_y_m}),
                   std::max(one.low_m.z, other.low_m.z)},
        high{std::min({one.high_m.x, other.high_m.x, far_x_m}),
             std::min({one.high_m.y, other.high_m.y, far_y_m}),
             std::min(one.high_m.z, other.high_m.z)};
    if (low.x >= high.x || low.y >= high.y || low.z >= high.z) return false;
    return share_a_point(a, b, {low, high}, overlap_halvings);
}

/// Whether a body shares volume with another one or with its images in the neighbouring periods.
bool shares_volume(const Body& a, Body b, const Domain& domain) {
    const Vec3 centre_m = b.centre_m;
    for (int x = -1; x <= 1; ++x)
        for (int y = -1; y <= 1; ++y) {
            b.centre_m.x = centre_m.x + x * domain.extent_x_m();
            b.centre_m.y = centre_m.y + y * domain.extent_y_m();
            if (shares_volume_here(a, b, domain)) return true;
        }
    return false;
}

/// Calls use(layer) for all layers between the top and the bottom of a body.
template <class Use>
void each_layer_around(const Body& body, const Medium& medium, const Use& use) {
    const Bounds box = bounds(body);
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const bool last = i + 1 == medium.layers.size();
        const DepthRange range = depths(medium, i);
        if (box.high_m.z > range.top_m && (last || box.low_m.z < range.bottom_m))
            use(medium.layers[i]);
    }
}

std::string reason_against(const Case& c, const Body& body, Endless along) {
    if (!(bounds(body).low_m.z > 0.0))
        return fmt::format("a rigid body must not touch the surface, but it begins at {:.4g} mm",
                           1e3 * bounds(body).low_m.z);
    const Bounds box = bounds(body);
    const double size_x_m = box.high_m.x - box.low_m.x, size_y_m = box.high_m.y - box.low_m.y;
    const double width_m = along == Endless::along_x   ? size_y_m
                           : along == Endless::along_y ? size_x_m
                                                       : lateral_thickness_m(body);
    if (width_m < least_spacings * c.domain.spacing_m)
        return fmt::format("a rigid body must be at least {:.3g} grid spacings wide, but it is "
                           "{:.4g} mm wide and domain.spacing_mm is {:.4g}",
                           least_spacings, 1e3 * width_m, 1e3 * c.domain.spacing_m);
    if (along == Endless::no && std::isfinite(size_x_m) &&
        (size_x_m >= c.domain.extent_x_m() || size_y_m >= c.domain.extent_y_m()))
        return "a rigid body that is as long as the domain must be parallel to x or y and either "
               "a cylinder without length_mm or a box that extends from edge to edge";
    if (body.edge_m > 0.0) return "a rigid body has a sharp surface; remove edge_mm";
    return "";
}

/// The rigid bodies with markers.
std::vector<Body> moving_bodies(const Case& c) {
    std::vector<Body> bodies = rigid_bodies(c);
    std::erase_if(bodies,
                  [&](const Body& body) { return !has_markers(body, c.scene.medium, c.domain); });
    return bodies;
}

/// Endless if each wavenumber along an axis can be treated by itself: all of these rigid bodies
/// with markers cross the domain along this axis.
RigidTreatment treatment_of(const std::vector<Body>& moving, const Domain& domain) {
    if (moving.empty()) return RigidTreatment::none;
    const Endless axis = endless_along(moving.front(), domain);
    const bool decouples =
        axis != Endless::no && std::ranges::all_of(moving, [&](const Body& body) {
            return endless_along(body, domain) == axis;
        });
    return decouples ? RigidTreatment::endless : RigidTreatment::lumps;
}

/// Whether moving_bodies() need a common system.
bool has_lumps(const Case& c) {
    return treatment_of(moving_bodies(c), c.domain) == RigidTreatment::lumps;
}

/// About twice the number of markers of a lump: the squares of the grid on the faces of its bounds.
double squares_around(const Body& body, const Domain& domain) {
    const Bounds box = bounds(lump_in(body, domain));
    const Vec3 size = (1.0 / domain.spacing_m) * (box.high_m - box.low_m);
    return 2.0 * (size.x * size.y + size.y * size.z + size.z * size.x);
}

/// Number of markers of a lump below the surface.
std::size_t marker_count(const Body& body, const Domain& domain) {
    return bounds(body).low_m.z > 0.0 ? lump_markers(body, domain, domain.spacing_m).size() : 0;
}

/// Why a body cannot be rigid; overlaps only with bodies that `meets` accepts.
template <class Meets>
std::vector<std::string> reasons_against(const Case& c, std::size_t i, const Meets& meets) {
    const std::vector<Body>& bodies = c.scene.medium.bodies;
    const std::string reason = reason_against(c, bodies[i], endless_along(bodies[i], c.domain));
    if (!reason.empty()) return {reason};
    std::vector<std::string> reasons;
    for (std::size_t j = 0; j < bodies.size(); ++j)
        if (j != i && meets(j) && shares_volume(bodies[i], bodies[j], c.domain))
            reasons.push_back(fmt::format("a rigid body must not overlap another body, but it "
                                          "overlaps medium.body[{}]",
                                          j + 1));
    return reasons;
}

} // namespace

Endless endless_along(const Body& body, const Domain& domain) {
    if (is_turned(body)) return Endless::no;
    const auto of_cylinder = [](const Cylinder& cylinder) {
        if (cylinder.axis == CylinderAxis::vertical || !cylinder.is_endless()) return Endless::no;
        const double turn_deg = std::abs(std::remainder(cylinder.azimuth_deg, 180.0));
        if (turn_deg == 0.0) return Endless::along_x;
        return turn_deg == 90.0 ? Endless::along_y : Endless::no;
    };
    const auto of_box = [&](const Box& box) {
        const bool x = spans(body.centre_m.x, box.size_m.x, domain.extent_x_m());
        const bool y = spans(body.centre_m.y, box.size_m.y, domain.extent_y_m());
        if (x && y) return Endless::both;
        return x ? Endless::along_x : y ? Endless::along_y : Endless::no;
    };
    return std::visit(overloaded{[](const Ellipsoid&) { return Endless::no; }, of_cylinder, of_box},
                      body.shape);
}

double stiffness_contrast(const Body& body, const Medium& medium) {
    if (!body.c_s_m_s) return 0.0;
    double contrast = std::numeric_limits<double>::infinity();
    each_layer_around(body, medium, [&](const Layer& layer) {
        const double density_kg_m3 = body.density_kg_m3.value_or(layer.density_kg_m3);
        contrast = std::min(contrast,
                            density_kg_m3 * std::pow(*body.c_s_m_s, 2) / material_of(layer).mu_Pa);
    });
    return contrast;
}

namespace {

/// Ends the medium at the uppermost rigid body that is a complete layer.
Case above_rigid_layers(Case c) {
    Medium& medium = c.scene.medium;
    double end_m = std::numeric_limits<double>::infinity();
    for (const Body& body : medium.bodies)
        if (body.rigid && endless_along(body, c.domain) == Endless::both)
            end_m = std::min(end_m, bounds(body).low_m.z);
    if (std::isinf(end_m)) return c;
    constexpr double rounding = 1e-9;
    std::erase_if(medium.bodies, [&](const Body& body) {
        return bounds(body).low_m.z >= end_m * (1.0 - rounding);
    });
    while (medium.layers.size() > 1 &&
           depths(medium, medium.layers.size() - 1).top_m >= end_m * (1.0 - rounding))
        medium.layers.pop_back();
    medium.layers.back().thickness_m = end_m - depths(medium, medium.layers.size() - 1).top_m;
    medium.base = Base::rigid;
    return c;
}

/// Why an elastic body that is stiff enough is not treated as rigid, or an empty text if it is.
std::string obstacle(const Case& c, std::size_t i) {
    const Body& body = c.scene.medium.bodies[i];
    bool is_light = false;
    each_layer_around(body, c.scene.medium, [&](const Layer& layer) {
        is_light |= body.density_kg_m3.value_or(layer.density_kg_m3) < layer.density_kg_m3;
    });
    if (is_light) return "it is lighter than its surroundings";
    const double spacings = lateral_thickness_m(body) / c.domain.spacing_m;
    if (endless_along(body, c.domain) == Endless::no && spacings < accurate_spacings)
        return fmt::format("it is {:.3g} grid spacings wide, and elastic bodies are more accurate "
                           "below {:.2g}",
                           spacings, accurate_spacings);
    Case chosen = c;
    chosen.scene.medium.bodies[i].rigid = true;
    const auto reasons = reasons_against(chosen, i, [](std::size_t) { return true; });
    if (!reasons.empty()) return reasons.back();
    std::size_t more = 0; // markers
    const auto add = [&](const Body& lump) {
        if (!has_markers(lump, chosen.scene.medium, c.domain)) return;
        more += squares_around(lump, c.domain) > most_squares ? most_markers + 1
                                                              : marker_count(lump, c.domain);
    };
    if (has_lumps(chosen) && has_lumps(c))
        add(body);
    else if (has_lumps(chosen))
        std::ranges::for_each(moving_bodies(chosen), add);
    if (more > most_markers)
        return fmt::format("it would need more than {} markers, and elastic bodies are faster then",
                           most_markers);
    return "";
}

} // namespace

RigidPlan rigid_plan(Case given) {
    const double above = std::get<SpectralOptions>(given.solver).rigid_above;
    std::vector<std::string> reasons(given.scene.medium.bodies.size());
    for (std::size_t i = 0; i < reasons.size(); ++i) {
        Body& body = given.scene.medium.bodies[i];
        const double contrast = stiffness_contrast(body, given.scene.medium);
        if (body.rigid || !(contrast > above * (1.0 + 1e-9))) continue;
        const std::string against = obstacle(given, i);
        body.rigid = against.empty();
        reasons[i] = body.rigid
                         ? fmt::format(" because it is {:.3g} times stiffer than its surroundings "
                                       "(rigid_above = {:.4g})",
                                       contrast, above)
                         : ". It is not treated as rigid: " + against;
    }
    RigidPlan plan(std::move(given));
    plan.reasons = std::move(reasons);
    return plan;
}

std::vector<Body> rigid_bodies(const Case& c) {
    std::vector<Body> rigid;
    for (const Body& body : c.scene.medium.bodies)
        if (body.rigid) rigid.push_back(body);
    return rigid;
}

RigidPlan::RigidPlan(Case given)
    : marked(std::move(given)), c(above_rigid_layers(marked)), layers(c), bodies(rigid_bodies(c)),
      treatment(treatment_of(bodies, c.domain)), reasons(marked.scene.medium.bodies.size()) {
    std::erase_if(layers.scene.medium.bodies, [](const Body& body) { return body.rigid; });
    if (treatment == RigidTreatment::endless)
        why = fmt::format("the rigid bodies have one system per wavenumber along {}, because all "
                          "of them cross the domain along it",
                          endless_along(bodies.front(), c.domain) == Endless::along_x ? "x" : "y");
    else if (treatment == RigidTreatment::lumps)
        why = bodies.size() == 1
                  ? "the rigid body has one system for all its markers, because it does "
                    "not cross the domain"
                  : "the rigid bodies have one system for all markers, because not "
                    "all of them cross the domain along the same axis";
}

bool is_below_rigid_layer(const Body& body, const Medium& medium, const Domain& domain) {
    return std::any_of(medium.bodies.begin(), medium.bodies.end(), [&](const Body& other) {
        return other.rigid && endless_along(other, domain) == Endless::both &&
               bounds(other).high_m.z <= bounds(body).low_m.z * (1.0 + 1e-9);
    });
}

bool has_markers(const Body& body, const Medium& medium, const Domain& domain) {
    return endless_along(body, domain) != Endless::both &&
           !is_below_rigid_layer(body, medium, domain);
}

std::string reason_of_rest(const Body& body, const Medium& medium, const Domain& domain) {
    if (body.fixed) return "fixed";
    // The tissue below is nearly incompressible and ends at the same edges.
    if (endless_along(body, domain) == Endless::both) return "held because it is a complete layer";
    if (is_below_rigid_layer(body, medium, domain))
        return "at rest because it lies below a rigid layer";
    if (medium.base != Base::rigid) return "";
    const double base_m = depths(medium, medium.layers.size() - 1).bottom_m;
    return bounds(body).high_m.z >= base_m * (1.0 - 1e-9) ? "held by the rigid base" : "";
}

std::vector<Remark> rigid_limits(const Case& c) {
    std::vector<Remark> refused;
    const std::vector<Body>& bodies = c.scene.medium.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (!bodies[i].rigid) continue;
        const auto first_of_pair = [&](std::size_t j) { return j < i || !bodies[j].rigid; };
        for (std::string& reason : reasons_against(c, i, first_of_pair))
            refused.push_back(
                {Severity::error, fmt::format("medium.body[{}].rigid", i + 1), std::move(reason)});
    }
    double squares = 0.0;
    if (has_lumps(c))
        for (const Body& body : moving_bodies(c))
            squares += squares_around(body, c.domain);
    if (refused.empty() && squares > most_squares)
        refused.push_back(
            {Severity::error, "domain.spacing_mm",
             fmt::format("the bounds of the rigid bodies have {:.2g} squares of the grid, but at "
                         "most {:.2g} are supported: use a larger spacing, or omit rigid",
                         squares, most_squares)});
    return refused;
}

std::vector<Remark> receptors_near_bodies(const Case& c) {
    std::vector<Remark> warnings;
    const std::vector<Body>& bodies = c.scene.medium.bodies;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        if (!bodies[i].rigid || !has_markers(bodies[i], c.scene.medium, c.domain)) continue;
        const Bounds box = bounds(bodies[i]);
        const double near_m = near_spacings * c.domain.spacing_m;
        for (const double depth_m : stress_depths_m(c)) {
            if (depth_m < box.low_m.z - near_m || depth_m > box.high_m.z + near_m) continue;
            warnings.push_back(
                {Severity::warning, fmt::format("medium.body[{}].rigid", i + 1),
                 fmt::format(
                     "receptors at a depth of {:.3g} mm may lie inside this body or within {:.3g} "
                     "grid spacings of it, where the error of their stress reaches {:.2g} % of the "
                     "largest stress around the body",
                     1e3 * depth_m, near_spacings, stress_error_percent(bodies[i]))});
            break;
        }
    }
    return warnings;
}

InsideBodies::InsideBodies(const Case& c, const fft::SlabShare& share)
    : bodies_(rigid_bodies(c)), domain_(c.domain), share_(share) {}

template <class Use>
void InsideBodies::each_point(double depth_m, const Use& use) const {
    for (std::size_t body = 0; body < bodies_.size(); ++body) {
        const Bounds box = bounds(bodies_[body]);
        if (depth_m < box.low_m.z || depth_m > box.high_m.z) continue;
        const Vec3 centre = bodies_[body].centre_m;
        for (std::ptrdiff_t i = 0; i < share_.x_count; ++i)
            for (std::ptrdiff_t j = 0; j < domain_.ny; ++j) {
                // A body continues beyond the periodic edge.
                const Vec3 offset{std::remainder(domain_.x_m(share_.x_start + i) - centre.x,
                                                 domain_.extent_x_m()),
                                  std::remainder(domain_.y_m(j) - centre.y, domain_.extent_y_m()),
                                  depth_m - centre.z};
                if (volume_fraction(bodies_[body], centre + offset, {}) > 0.5)
                    use(i * share_.padded_ny + j, body, offset);
            }
    }
}

void InsideBodies::set_displacement(double depth_m, std::size_t component,
                                    const std::vector<RigidMotion>& motions, double* plane) const {
    each_point(depth_m, [&](std::ptrdiff_t at, std::size_t body, Vec3 offset) {
        const Vec3 u = motions[body].at(offset);
        plane[at] = component == 0 ? u.x : component == 1 ? u.y : u.z;
    });
}

void InsideBodies::clear(double depth_m, double* plane) const {
    each_point(depth_m, [&](std::ptrdiff_t at, std::size_t, Vec3) { plane[at] = 0.0; });
}

} // namespace shearwake::spectral
