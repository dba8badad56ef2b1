// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_systems.hpp"
#include "engines/spectral/bodies/rigid_bodies.hpp"

#include <vector>

namespace shearwake::spectral {

/// Rigid bodies that cross the domain along x or y. Along the axis the constraint holds for each
/// wavenumber by itself: at wavenumber 0 the section moves rigidly, at all others it is at rest.
class EndlessBodies : public RigidBodies {
public:
    EndlessBodies(const RigidPlan& plan, const DepthMesh& mesh, const WaveVectors& vectors,
                  double step_s, const Comm& team);

    void assemble(const VerticalOperator& op, const Solve& solve) override;
    void clear() override;
    void evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil) override;
    void end_row(std::ptrdiff_t row) override;
    void begin_forces(std::ptrdiff_t row) override;
    void add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) override;
    engines::Allocation array() const override;
    std::vector<RigidMotion> motions() const override;

private:
    void solve(const std::vector<double>& target, double scale) override;
    Block* values_of(std::ptrdiff_t block) { // of a pencil's markers
        return markers_.along_x() ? blocks_.data() + block * per_pencil() : blocks_.data();
    }
    std::ptrdiff_t per_pencil() const { return markers_.count() * marker_parts; }
    /// Index of the first value of a system in values(), and the distance of its values.
    std::ptrdiff_t place(std::ptrdiff_t system) const;
    std::ptrdiff_t stride() const { return markers_.along_x() ? lane_count : 1; }
    double* values() { return markers_.along_x() ? scalars(blocks_.data()) : rows_.data(); }
    double rigid(std::size_t marker, std::ptrdiff_t part, const std::vector<double>& q) const;
    void add_mass();
    void prepare_motion();
    void solve_system(std::size_t index, const std::vector<double>& target, double scale);

    WaveVectors vectors_;
    SectionMarkers markers_;
    EndlessSystems systems_;
    const MarkerKernels& kernels_;
    /// Displacements, then forces of the markers: [block][marker][part] with one lane per system
    /// for an axis along x, otherwise those of one row with one lane per wave vector.
    fft::AlignedVector<Block> blocks_;
    std::vector<double> rows_; // [row][marker][part] for an axis along y
};

} // namespace shearwake::spectral
