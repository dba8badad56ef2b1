// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_bodies.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/endless_bodies.hpp"
#include "fft/slab_transform.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

/// A marker's offset from the centre of its body, and its depth.
struct Placed {
    std::size_t body;
    Vec3 offset_m;
    double depth_m;
};

/// The markers of all lumps, ordered by depth. The base holds what reaches it.
std::vector<Placed> placed_markers(const RigidPlan& plan, const DepthMesh& mesh) {
    const std::vector<Body>& bodies = plan.bodies;
    std::vector<Placed> all;
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Bounds box = bounds(bodies[i]);
        const double high_m = level_spacing_m(mesh, box.low_m.z, box.high_m.z);
        for (const Vec3& offset : lump_markers(bodies[i], plan.c.domain, high_m)) {
            const double depth_m = bodies[i].centre_m.z + offset.z;
            if (depth_m < mesh.ends_m.back() - 0.3 * high_m) all.push_back({i, offset, depth_m});
        }
    }
    std::stable_sort(all.begin(), all.end(),
                     [](const Placed& a, const Placed& b) { return a.depth_m < b.depth_m; });
    return all;
}

std::ptrdiff_t wrapped(std::ptrdiff_t i, std::ptrdiff_t period) {
    return (i % period + period) % period;
}

} // namespace

std::array<double, kernel_points> kernel_weights(double offset) {
    const double nearest = (1.0 + std::sqrt(1.0 - 3.0 * offset * offset)) / 3.0;
    return {0.5 * (1.0 - nearest - offset), nearest, 0.5 * (1.0 - nearest + offset)};
}

LumpBodies::LumpBodies(const RigidPlan& plan, const DepthMesh& mesh,
                       const fft::SlabTransform& slabs, const WaveVectors& vectors, double step_s,
                       const Comm& team)
    : RigidBodies(plan, lump_freedoms, step_s, team), domain_(plan.c.domain), mesh_(mesh),
      slabs_(slabs), vectors_(vectors), inverse_(3 * placed_markers(plan, mesh).size(), team) {
    // Its periodic images keep a body that crosses the domain from turning about the other axes.
    for (std::size_t i = 0; i < bodies().size(); ++i) {
        const Endless along = endless_along(bodies()[i], domain_);
        if (along == Endless::along_x) constrain(i, {4, 5});
        if (along == Endless::along_y) constrain(i, {3, 5});
    }
    place_markers(plan, mesh);
    planes_ =
        std::make_unique<DisplacementPlanes>(depths_, place_taps(), mesh, vectors, slabs, team);
    for (Tap& tap : taps_) {
        const std::size_t depth = markers_[tap.marker].depth;
        tap.at += planes_->first(depth);
        tap.stride = planes_->cells(depth);
    }
    values_.assign(planes_->size(), 0.0);
}

void LumpBodies::place_markers(const RigidPlan& plan, const DepthMesh& mesh) {
    double last_m = 0.0;
    for (const Placed& p : placed_markers(plan, mesh)) {
        if (depths_.empty() || p.depth_m != last_m)
            depths_.push_back(depth_weights(mesh, p.depth_m));
        last_m = p.depth_m;
        const Vec3 at = bodies()[p.body].centre_m + p.offset_m;
        const double x = (at.x - domain_.x_m(0)) / domain_.spacing_m,
                     y = (at.y - domain_.y_m(0)) / domain_.spacing_m;
        markers_.push_back({.body = p.body,
                            .depth = depths_.size() - 1,
                            .offset_m = p.offset_m,
                            .x = static_cast<std::ptrdiff_t>(std::round(x)),
                            .y = static_cast<std::ptrdiff_t>(std::round(y)),
                            .along_x = kernel_weights(x - std::round(x)),
                            .along_y = kernel_weights(y - std::round(y))});
    }
}

/// Finds the points of all markers on this rank and returns the runs of each depth.
DisplacementPlanes::Runs LumpBodies::place_taps() {
    const fft::SlabShare& share = slabs_.share();
    const std::ptrdiff_t ny = domain_.ny;
    DisplacementPlanes::Runs runs(depths_.size());
    std::size_t begin = 0;
    for (std::size_t depth = 0; depth < depths_.size(); ++depth) {
        std::vector<char> used(static_cast<std::size_t>(share.x_count * ny), 0);
        std::vector<std::size_t> place(used.size(), 0);
        const std::size_t first_tap = taps_.size();
        std::size_t m = begin;
        for (; m < markers_.size() && markers_[m].depth == depth; ++m)
            for (std::ptrdiff_t i = 0; i < kernel_points; ++i)
                for (std::ptrdiff_t j = 0; j < kernel_points; ++j) {
                    const std::ptrdiff_t row =
                        wrapped(markers_[m].x + i - 1, domain_.nx) - share.x_start;
                    if (row < 0 || row >= share.x_count) continue;
                    const auto at =
                        static_cast<std::size_t>(row * ny + wrapped(markers_[m].y + j - 1, ny));
                    used[at] = 1;
                    taps_.push_back({m, at, 0,
                                     markers_[m].along_x[static_cast<std::size_t>(i)] *
                                         markers_[m].along_y[static_cast<std::size_t>(j)]});
                }
        begin = m;
        std::size_t cells = 0;
        for (std::ptrdiff_t row = 0; row < share.x_count; ++row)
            for (std::ptrdiff_t j = 0; j < ny; ++j) {
                const auto at = static_cast<std::size_t>(row * ny + j);
                if (!used[at]) continue;
                if (j == 0 || !used[at - 1]) runs[depth].push_back({row, j, j, cells});
                ++runs[depth].back().end;
                place[at] = cells++;
            }
        for (std::size_t tap = first_tap; tap < taps_.size(); ++tap)
            taps_[tap].at = place[taps_[tap].at];
    }
    return runs;
}

void LumpBodies::assemble(const VerticalOperator& op, const Solve& solve) {
    put_responses(op, solve);
    if (!inverse_.invert())
        throw CaseFailure("the forces at the surfaces of the rigid bodies are not determined; the "
                          "bodies may be too close to each other or to the surface, or "
                          "domain.spacing_mm too large");
    std::vector<std::vector<double>> masses;
    for (const Body& body : bodies())
        masses.push_back(lump_mass(body, domain_, medium()));
    set_mass(masses, 1.0 / (domain_.extent_x_m() * domain_.extent_y_m()));
    std::vector<double> motion;
    for (std::size_t f = 0; f < free_count(); ++f) {
        const std::vector<double> column = rigid(unit(f));
        motion.insert(motion.end(), column.begin(), column.end());
    }
    prepare(motion, motion.empty() ? motion : inverse_.multiply(motion));
}

void LumpBodies::add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) {
    planes_->add_force(row, block, 1.0 / (domain_.extent_x_m() * domain_.extent_y_m()), pencil);
}

std::vector<RigidMotion> LumpBodies::motions() const {
    std::vector<RigidMotion> all;
    for (std::size_t i = 0; i < bodies().size(); ++i) {
        const double* q = position().data() + i * lump_freedoms;
        all.push_back({{q[0], q[1], q[2]}, {q[3], q[4], q[5]}});
    }
    return all;
}

std::vector<double> LumpBodies::rigid(const std::vector<double>& q) const {
    std::vector<double> all;
    for (const Marker& m : markers_) {
        const double* of = q.data() + m.body * lump_freedoms;
        const Vec3 u = RigidMotion{{of[0], of[1], of[2]}, {of[3], of[4], of[5]}}.at(m.offset_m);
        all.insert(all.end(), {u.x, u.y, u.z});
    }
    return all;
}

void LumpBodies::solve(const std::vector<double>& target, double scale) {
    planes_->get(values_);
    std::vector<double> lack(inverse_.size(), 0.0);
    for (const Tap& tap : taps_)
        for (std::size_t c = 0; c < 3; ++c)
            lack[3 * tap.marker + c] += tap.weight * values_[tap.at + c * tap.stride];
    team().sum(std::span<double>(lack));
    const std::vector<double> goal = rigid(target);
    for (std::size_t i = 0; i < lack.size(); ++i)
        lack[i] = (goal[i] - lack[i]) / scale;
    std::vector<double> forces = inverse_.multiply(lack);
    move(lack.data(), forces.data());
    exert(forces);
}

void LumpBodies::exert(const std::vector<double>& forces) {
    std::fill(values_.begin(), values_.end(), 0.0);
    for (const Tap& tap : taps_)
        for (std::size_t c = 0; c < 3; ++c)
            values_[tap.at + c * tap.stride] += tap.weight * forces[3 * tap.marker + c];
    planes_->set(values_);
}

std::unique_ptr<RigidBodies> make_rigid_bodies(const RigidPlan& plan, const DepthMesh& mesh,
                                               const fft::SlabTransform& slabs,
                                               const WaveVectors& vectors, double step_s,
                                               const Comm& team) {
    if (plan.treatment == RigidTreatment::lumps)
        return std::make_unique<LumpBodies>(plan, mesh, slabs, vectors, step_s, team);
    return std::make_unique<EndlessBodies>(plan, mesh, vectors, step_s, team);
}

LumpSizes lump_sizes(const RigidPlan& plan, const DepthMesh& mesh) {
    const Domain& domain = plan.c.domain;
    LumpSizes sizes;
    double last_m = -1.0;
    for (const Placed& p : placed_markers(plan, mesh)) {
        sizes.markers += 1.0;
        if (p.depth_m != last_m) sizes.depths += 1.0;
        last_m = p.depth_m;
    }
    Vec3 low{1e9, 1e9, 0.0}, high{-1e9, -1e9, 0.0};
    for (const Body& body : plan.bodies) {
        const Bounds box = bounds(lump_in(body, domain));
        low = {std::min(low.x, box.low_m.x), std::min(low.y, box.low_m.y), 0.0};
        high = {std::max(high.x, box.high_m.x), std::max(high.y, box.high_m.y), 0.0};
    }
    const auto points = [&](double length_m, std::ptrdiff_t most) {
        return std::clamp(length_m / domain.spacing_m + static_cast<double>(kernel_points), 0.0,
                          static_cast<double>(most));
    };
    if (sizes.markers > 0.0) {
        sizes.points_x = points(high.x - low.x, domain.nx);
        sizes.points_y = points(high.y - low.y, domain.ny);
    }
    return sizes;
}

double lump_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks) {
    const Domain& domain = plan.c.domain;
    const LumpSizes sizes = lump_sizes(plan, mesh);
    const double unknowns = 3.0 * sizes.markers, planes = 3.0 * sizes.depths;
    const auto lines = static_cast<double>(fft::most_rows(domain.ny, ranks));
    const double of_line = LineWindow::pays(domain.nx, static_cast<std::ptrdiff_t>(sizes.points_x))
                               ? sizes.points_x
                               : static_cast<double>(domain.nx);
    // The inverse; the planes of a step and those of the setup, with their values on all ranks.
    return sizeof(double) * (unknowns * unknowns / ranks + 4.0 * planes * lines * of_line +
                             2.0 * planes * sizes.points_x * sizes.points_y + 6.0 * unknowns);
}

} // namespace shearwake::spectral
