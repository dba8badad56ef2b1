// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/stepping/stages.hpp"

#include <optional>
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
///   1. output      saves what strain and stress at the start of the step need;
///   2. sponge      every few steps, removes a share of u - u- in the margin of the domain;
///   3. pencils     d = B^-1 (f - K u - C (u - u-)/dt + explicit stress of elastic bodies), u+;
///   4. energy      compares the kinetic energy with the work of the load;
///   5. constraint  adds the response to the forces at the markers of rigid bodies to d;
///   6. variation   iterates for e, adds B^-1 E^T S e to d, and advances the strains.
/// If a box contains the elastic bodies and there are no rigid ones, 3 yields d without elastic
/// bodies, and 6 adds the response to their explicit and implicit stress together. In the same
/// pass, 6 usually does 3 of the next step.
class Stepper : public engines::Marching {
public:
    /// `per_frame`: number of steps of a frame; 0: without output. Throws CaseFailure on all
    /// ranks together. Collective.
    Stepper(RigidPlan bodies, const DepthMesh& mesh, const fft::SlabTransform& slabs, double step_s,
            const Comm& team, std::ptrdiff_t per_frame = 0);

    /// Advances from t = n dt to (n + 1) dt. Throws CaseFailure or FieldDiverges on all ranks
    /// together. Collective.
    void advance() override;
    std::ptrdiff_t step() const override { return state_.step; }
    void emit(engines::Observer& observer) override {
        if (output_) output_->emit(observer);
    }
    /// To be called after the last step: takes one more step if the strain or stress at its end is
    /// required. Collective.
    void finish(engines::Observer& observer);

    /// The stepper must be of the same case.
    void save(StateWriter& state) const override;
    void restore(const StateReader& state) override;

    /// The arrays of all stages on this rank. Not collective.
    std::vector<engines::Allocation> arrays() const;

    EnergyBalance energy() { return energy_of(state_); }

    void plane_of_w(double depth_m, double* plane) const {
        put_plane(state_, 2, depth_weights(state_.mesh, depth_m), plane);
    }

    /// The pencils of the displacement at the current and the previous step, row by row.
    const fft::AlignedVector<Block>& now() const { return state_.now; }
    const fft::AlignedVector<Block>& before() const { return state_.before; }

    const StepStatistics& statistics() const { return state_.statistics; }
    /// The box on which iterations take place; nothing: complete planes.
    const std::optional<BoxGrid>& box() const { return box_; }
    const LateralField& field() const { return state_.field; }
    const RigidBodies& bodies() const { return *state_.bodies; }

private:
    StepState state_;
    std::optional<BoxGrid> box_;
    std::vector<std::unique_ptr<Stage>> stages_;
    OutputStage* output_ = nullptr; // among the stages
};

} // namespace shearwake::spectral
