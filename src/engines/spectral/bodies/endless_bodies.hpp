// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_systems.hpp"
#include "parallel/state.hpp"

#include <vector>

namespace shearwake::spectral {

/// Rigid bodies that cross the domain along x or y, as a constraint on a step: forces F at markers
/// on their surfaces and inside make the markers move rigidly,
///     J u+ = R q+,   B d = rhs + J' F,   M (q+ - 2 q + q-)/dt^2 = -R' F,
/// with the displacement J u at the markers, the degrees of freedom q of all bodies, their motion R
/// at the markers and their mass M in excess of the background in their place. With G = J B^-1 J'
/// and the displacement v of the markers without the forces of this step,
///     G F = (R q+ - v)/scale,   (M/dt^2 + R' G^-1 R) a = R' G^-1 (v - R (2 q - q-))/scale,
/// q+ = 2 q - q- + scale a. The forces do no work, so the energy of the scheme, which then includes
/// that of M, changes as without bodies. v is that of the next displacement and not of its change;
/// rounding errors of the constraint are therefore corrected in the next step.
///
/// Along the axis the constraint holds for each wavenumber by itself: at wavenumber 0 the section
/// moves rigidly, at all others it is at rest.
///
/// A step calls clear(); evaluate() for the pencils of a row and end_row(); advance() or respond();
/// and then begin_forces() for a row and add_force() for its pencils.
class EndlessBodies {
public:
    EndlessBodies(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors, double step_s,
                  const Comm& team);

    bool empty() const { return bodies_.empty(); }
    /// Computes the systems. Throws CaseFailure on all ranks together. Collective.
    void assemble(const VerticalOperator& op, const EndlessSystems::Solve& solve);

    // Not collective.
    void clear();
    void evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil);
    void end_row(std::ptrdiff_t row);
    void begin_forces(std::ptrdiff_t row);
    void add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) const;

    /// Determines the forces that correct the evaluated next displacement, and advances the bodies.
    /// Collective.
    void advance(double scale);
    /// Determines the forces and the acceleration with which the bodies respond to the evaluated
    /// change of the displacement. Collective.
    void respond();
    /// Adds `scale` times the acceleration to the next position, or to the current position and its
    /// negative to the previous one. Not collective.
    void add_to_next(double scale);
    void add_impulse();
    /// The next position becomes the current one. Not collective.
    void end_step() { now_.swap(before_); }

    /// Twice the energy per area of the mass in excess of the background [J/m^2]. Not collective.
    double twice_kinetic_J_m2() const;
    /// Degrees of freedom of all bodies, [body][section_freedoms].
    const std::vector<double>& position() const { return now_; }
    double memory_B() const;

    /// Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

private:
    Block* values_of(std::ptrdiff_t block) { // of a pencil's markers
        return markers_.along_x() ? blocks_.data() + block * per_pencil() : blocks_.data();
    }
    std::ptrdiff_t per_pencil() const { return markers_.count() * marker_parts; }
    /// Index of the first value of a system in values(), and the distance of its values.
    std::ptrdiff_t place(std::ptrdiff_t system) const;
    std::ptrdiff_t stride() const { return markers_.along_x() ? lane_count : 1; }
    double* values() { return markers_.along_x() ? scalars(blocks_.data()) : rows_.data(); }
    double rigid(std::size_t marker, std::ptrdiff_t part, const std::vector<double>& q) const;
    DistributedRows state_rows() const;
    void take_mass();
    void solve(const std::vector<double>& target, double scale);
    void solve_system(std::size_t index, const std::vector<double>& target, double scale);

    std::vector<Body> bodies_;
    Medium medium_;
    WaveVectors vectors_;
    Comm team_;
    double step_s_;
    SectionMarkers markers_;
    EndlessSystems systems_;
    const MarkerKernels& kernels_;
    std::vector<double> now_, before_, acceleration_;
    std::vector<std::size_t> free_; // degrees of freedom of bodies that are not held
    std::vector<double> mass_;      // of the free ones, [row][column]
    /// With K = M/dt^2 + R' G^-1 R: G^-1 R and K^-1 of the free degrees of freedom, on rank 0.
    std::vector<double> per_freedom_, mobility_;
    /// Displacements, then forces of the markers: [block][marker][part] with one lane per system
    /// for an axis along x, otherwise those of one row with one lane per wave vector.
    fft::AlignedVector<Block> blocks_;
    std::vector<double> rows_; // [row][marker][part] for an axis along y
};

} // namespace shearwake::spectral
