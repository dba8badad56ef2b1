// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/grid_forces.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/surface_patches.hpp"

#include <vector>

namespace shearwake::spectral {

/// Correction of the stress that the engine computes around lumps, at some depths.
///
/// A marker exerts its force on a few points of the grid, and the forces vary from marker to
/// marker. The displacement hardly depends on this, but the stress close to the body does.
/// Therefore the static stress of these forces as the engine computes it (GridForces) is replaced
/// by Kelvin's solution for the same forces spread over patches p_m of the surface:
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

    /// `lumps` must outlive this object. Forces have three components [N] for each marker. Not
    /// collective.
    NearStress(const LumpBodies& lumps, const Medium& medium, const Domain& domain,
               const DepthMesh& mesh, const fft::SlabShare& share, std::vector<double> depths_m);

    /// Computes the matrix of add_zz(). Not collective.
    void prepare_zz();
    /// Adds the correction of sigma_zz [Pa] at a depth, times `factor`, to a plane
    /// [x_count][padded_ny]. Not collective.
    void add_zz(std::size_t depth, const std::vector<double>& forces, double factor,
                double* plane) const;

    struct Correction {
        std::size_t place; // in a plane
        Stress stress_Pa;
    };
    /// The correction of the stress at all points of a depth where it does not vanish. Slower than
    /// add_zz() for a single component, but needs no preparation. Not collective.
    std::vector<Correction> corrections(std::size_t depth, const std::vector<double>& forces) const;

private:
    struct Point {
        std::size_t place;         // in a plane
        std::ptrdiff_t x, y;       // of the grid
        Vec3 at_m;                 // moved away from the surface if it is very close
        std::vector<bool> is_near; // per marker
    };
    struct Entry {
        std::size_t marker;
        double weights[3];
    };
    struct Row {
        std::size_t place;
        std::vector<Entry> entries;
    };
    std::vector<Point> find_points(std::size_t depth) const;
    bool moves_out(Vec3& at_m) const;
    Vec3 between(Vec3 from_m, Vec3 to_m) const;
    ForceStress of_grid(std::size_t depth, const Point& point, std::size_t marker) const;
    Row row(std::size_t depth, const Point& point) const;
    void add_patches(const Point& point, const std::vector<Vec3>& forces, Stress& sum) const;
    void add_grid(std::size_t depth, const Point& point, const std::vector<Vec3>& forces,
                  Stress& sum) const;

    const LumpBodies& lumps_;
    Domain domain_;
    fft::SlabShare share_;
    std::vector<double> depths_m_;
    double lambda_per_mu_;
    SurfacePatches patches_;
    std::vector<Vec3> marker_m_;
    GridForces grid_;
    std::vector<std::vector<Point>> points_; // per depth
    std::vector<std::vector<Row>> rows_; // per depth; the points of this rank, after prepare_zz()
};

/// Number of pairs of points and points of patches in the corrections of one volume. Not
/// collective.
double near_stress_pairs(const Case& c, const DepthMesh& mesh);
/// Memory of the corrections of a case on the rank that needs most, in bytes. Not collective.
double near_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
