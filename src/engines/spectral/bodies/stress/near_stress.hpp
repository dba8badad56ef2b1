// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/stress/stress_correction.hpp"
#include "engines/spectral/bodies/stress/surface_patches.hpp"
#include "problem/medium/medium.hpp"

#include <functional>
#include <vector>

namespace shearwake::spectral {

/// Rigid bodies, the points around them, and how forces act there. For bodies across the domain it
/// is a section: x across the axis, a single point y along it, and forces per length.
struct NearSolid {
    struct Part {
        Body body;
        Bounds box;
    };
    std::vector<Part> bodies;
    Domain domain;        // of the points
    fft::SlabShare share; // those of this rank
    std::vector<double> depths_m;
    SurfacePatches patches;
    std::vector<Vec3> marker_m;
    /// The stress due to unit forces at a marker, as the engine computes it at a point of the grid.
    std::function<ForceStress(std::size_t depth, std::ptrdiff_t x, std::ptrdiff_t y,
                              std::size_t marker)>
        of_engine;
    /// The stress due to a force at a distance in a solid without boundaries.
    std::function<Stress(Vec3 r_m, Vec3 force)> exact;
};

/// The ratio lambda/mu at a depth.
double ratio_at(const Medium& medium, double depth_m);

/// Correction of the stress that the engine computes around rigid bodies, at some depths.
///
/// A marker exerts its force on a few points of the grid, and the forces vary from marker to
/// marker. The displacement hardly depends on this, but the stress close to the body does.
/// Therefore the static stress of these forces as the engine computes it is replaced by that in a
/// solid without boundaries of the same forces spread over patches p_m of the surface:
///     sum over markers of F_m . [integral of K(x - s) p_m(s) ds - K_grid(x - x_m)].
/// Both have the same resultant, so their difference decreases quickly with the distance from the
/// surface, and inertia is negligible where it matters. The forces balance the elastic and the
/// viscous stress together, so their stress does not depend on mu or viscosity. The solid is
/// uniform: its ratio of moduli is that of the layer at the centre of the first body, which hardly
/// matters for nearly incompressible layers.
class NearStress {
public:
    /// Within this distance of the surface, in spacings, stresses are corrected.
    static constexpr double reach = 5.0;
    /// Largest distance of a marker from a point whose stress it corrects, in spacings: with the
    /// points of its kernel, at most that of GridForces.
    static constexpr double marker_reach = 8.0;

    /// Not collective, nor are the members.
    explicit NearStress(NearSolid solid);

    /// A row of the matrix from the forces of all markers to the correction at a point.
    struct Entry {
        std::size_t marker;
        ForceStress per_force;
    };
    struct Row {
        std::size_t place; // in a plane
        std::vector<Entry> entries;
    };
    /// Passes the rows of a depth to `use` one by one.
    void each_row(std::size_t depth, const std::function<void(Row&&)>& use) const;
    /// The correction at all points of a depth for forces (x, y, z) at all markers, without the
    /// matrix.
    std::vector<StressCorrection::Change> changes(std::size_t depth,
                                                  const std::vector<double>& forces) const;

private:
    struct Point {
        std::size_t place;         // in a plane
        std::ptrdiff_t x, y;       // of the grid
        Vec3 at_m;                 // moved away from the surface if it is very close
        std::vector<bool> is_near; // per marker
    };
    std::vector<Point> find_points(std::size_t depth) const;
    bool moves_out(Vec3& at_m) const;
    Vec3 between(Vec3 from_m, Vec3 to_m) const;
    bool reaches(Vec3 r_m) const;
    Row row(std::size_t depth, const Point& point) const;
    void add_patches(const Point& point, const std::vector<Vec3>& forces, Stress& sum) const;
    void add_engine(std::size_t depth, const Point& point, const std::vector<Vec3>& forces,
                    Stress& sum) const;

    NearSolid solid_;
    std::vector<std::vector<Point>> points_; // per depth
};

} // namespace shearwake::spectral
