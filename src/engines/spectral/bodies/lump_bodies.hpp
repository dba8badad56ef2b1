// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/block_inverse.hpp"
#include "engines/spectral/bodies/displacement_planes.hpp"
#include "engines/spectral/bodies/lump_markers.hpp"
#include "engines/spectral/bodies/rigid_bodies.hpp"

#include <memory>

namespace shearwake::spectral {

/// Points of the grid that the kernel of a marker covers along x and along y.
constexpr std::ptrdiff_t kernel_points = 3;
/// Weights of the point nearest to a marker and its neighbours; `offset` is the distance of the
/// marker from the nearest point, in spacings, -1/2 to 1/2. This is the kernel of Roma, Peskin and
/// Berger (J. Comput. Phys. 153, 1999): the sum is 1, the first moment is exact, and the sum of the
/// squares is 1/2 for all offsets. Its standard deviation is 0.5 to 0.58 spacings, similar to
/// marker_smoothing. Wider kernels make bodies larger: with the one of four points (0.72) the error
/// of the force on a sphere is two to three times as large.
std::array<double, kernel_points> kernel_weights(double offset);

/// Rigid bodies of any shape. Their markers evaluate the displacement
/// and exert their forces on 3 x 3 points of the grid. G = J B^-1 J' is one matrix for all bodies.
/// Between two points of the grid B^-1 depends on their depths and their lateral distance alone, so
/// it is determined by one solve per depth and direction. The inverse of G is distributed over the
/// ranks.
class LumpBodies : public RigidBodies {
public:
    struct Marker {
        std::size_t body, depth; // index of the body and of the depth
        Vec3 offset_m;           // from the centre of the body
        std::ptrdiff_t x, y;     // nearest point, not reduced to the domain
        std::array<double, kernel_points> along_x, along_y;
    };

    /// `slabs` must outlive this object. Collective.
    LumpBodies(const RigidPlan& plan, const DepthMesh& mesh, const fft::SlabTransform& slabs,
               const WaveVectors& vectors, double step_s, const Comm& team);

    void assemble(const VerticalOperator& op, const Solve& solve) override;
    void clear() override {}
    void evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil) override {
        planes_->evaluate(row, block, pencil);
    }
    void end_row(std::ptrdiff_t row) override { planes_->end_row(row); }
    void begin_forces(std::ptrdiff_t row) override { planes_->begin_row(row); }
    void add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) override;
    engines::Allocation array() const override {
        return {"rigid lumps", inverse_.memory_B() + planes_->memory_B()};
    }
    std::vector<RigidMotion> motions() const override;

    const std::vector<Marker>& markers() const { return markers_; }
    /// Forces [N], [marker][x, y, z], for such displacements [m] of all markers. Collective.
    std::vector<double> forces(const std::vector<double>& displacement) const {
        return inverse_.multiply(displacement);
    }
    /// Sets the forces of all markers that add_force() exerts. Collective.
    void exert(const std::vector<double>& forces);

private:
    /// A point of a marker on this rank.
    struct Tap {
        std::size_t marker, at, stride; // index of the values of x, and the distance to those of y
        double weight;
    };
    void solve(const std::vector<double>& target, double scale) override;
    /// Displacements of all markers, [marker][component], for degrees of freedom.
    std::vector<double> rigid(const std::vector<double>& q) const;
    void place_markers(const RigidPlan& plan, const DepthMesh& mesh);
    void put_responses(const VerticalOperator& op, const Solve& solve);
    DisplacementPlanes::Runs place_taps();

    Domain domain_;
    DepthMesh mesh_;
    const fft::SlabTransform& slabs_;
    WaveVectors vectors_;
    std::vector<Marker> markers_; // ordered by depth
    std::vector<DepthWeights> depths_;
    std::vector<Tap> taps_;
    std::unique_ptr<DisplacementPlanes> planes_;
    BlockInverse inverse_;
    std::vector<double> values_;
};

/// The rigid bodies of a case that are not complete layers. Collective.
std::unique_ptr<RigidBodies> make_rigid_bodies(const RigidPlan& plan, const DepthMesh& mesh,
                                               const fft::SlabTransform& slabs,
                                               const WaveVectors& vectors, double step_s,
                                               const Comm& team);

/// Sizes of the lumps. Not collective.
struct LumpSizes {
    double markers = 0.0, depths = 0.0;
    /// Points of a plane around the lumps along x and y.
    double points_x = 0.0, points_y = 0.0;
};
LumpSizes lump_sizes(const RigidPlan& plan, const DepthMesh& mesh);
/// Memory of the lumps on the rank that needs most, in bytes. Not collective.
double lump_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
