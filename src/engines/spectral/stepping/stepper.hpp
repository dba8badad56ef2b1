// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/stepping/stages.hpp"

#include <string>
#include <vector>

namespace shearwake::spectral {

/// The displacement over depth at this rank's wave vectors, and the step that advances it:
///     [M/dt^2 + a_lambda K_lambda + a_mu K_mu + C/(2 dt)] d = f - K u - C (u - u-)/dt,
///     u+ = 2u - u- + d;   from rest, u(dt) = d / 2.
/// Second order in dt for compressional and viscous forces, fourth order for shear. Where the
/// medium varies laterally, the stress in addition to that of the layers is computed in (x, y)
/// space from strains that are advanced together with u. The operator is then either a background
/// at least as stiff as the medium (one solve per step) or the true operator, A = B + E^T S E. With
/// e = E d the latter becomes (1 + E B^-1 E^T S) e = E B^-1 rhs, which is solved by conjugate
/// gradients. This takes the same number of iterations as preconditioning A with B, but its vectors
/// cover only the cells where the medium varies. Rigid bodies are a constraint (RigidBodies):
/// every solve with B is followed by one for the forces at their markers.
///
/// A step from n dt to (n + 1) dt consists of these stages, in this order:
///   1. sponge      every few steps, removes a share of u - u- in the margin of the domain;
///   2. pencils     d = B^-1 (f - K u - C (u - u-)/dt + explicit stress of elastic bodies), u+;
///   3. energy      compares the kinetic energy with the work of the load;
///   4. constraint  adds the response to the forces at the markers of rigid bodies to d;
///   5. variation   iterates for e, adds B^-1 E^T S e to d, and advances the strains.
/// If a box contains the elastic bodies and there are no rigid ones, 2 yields d without elastic
/// bodies, and 5 adds the response to their explicit and implicit stress together.
class Stepper {
public:
    /// Throws CaseFailure on all ranks together. Collective.
    Stepper(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs, double step_s,
            const Comm& team);

    /// Advances from t = n dt to (n + 1) dt. Throws CaseFailure or FieldDiverges on all ranks
    /// together. Collective.
    void advance();
    /// Number of steps so far.
    std::ptrdiff_t step() const { return state_.step; }

    /// Save and restore everything that changes from step to step; the stepper must be of the same
    /// case. Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

    /// The arrays of all stages on this rank. Not collective.
    std::vector<engines::Array> arrays() const;

    EnergyBalance energy() { return energy_of(state_); }

    /// u_z [m] at a depth as rows of the transposed spectrum, in the layout of SlabTransform. Not
    /// collective.
    void plane_of_w(double depth_m, double* plane) const;

    /// A component of u (0: x, 1: y, 2: z) at a level, in the same layout as plane_of_w(). Not
    /// collective.
    void plane_of_u(std::size_t component, std::size_t level, double* plane) const;

    /// The pencils of the displacement at the current and the previous step, row by row.
    const fft::AlignedVector<Block>& now() const { return state_.now; }
    const fft::AlignedVector<Block>& before() const { return state_.before; }

    const std::vector<std::string>& notes() const { return state_.field.variation().notes; }
    const StepStatistics& statistics() const { return state_.statistics; }
    /// Whether the iterations use the matrices of a box instead of complete planes.
    bool uses_box() const { return uses_box_; }
    const StepClock& clock() const { return state_.clock; }
    const StrainPlanes& planes() const { return state_.planes; }
    const LateralField& field() const { return state_.field; }
    const RigidBodies& bodies() const { return *state_.bodies; }

private:
    /// The box of the elastic bodies if it accelerates the iterations. Collective.
    std::optional<BoxGrid> box() const;

    StepState state_;
    bool uses_box_;
    std::vector<std::unique_ptr<Stage>> stages_;
};

} // namespace shearwake::spectral
