// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/lateral/box_response.hpp"
#include "engines/spectral/lateral/strain_solver.hpp"
#include "engines/spectral/stepping/step_state.hpp"

#include <memory>
#include <optional>
#include <vector>

namespace shearwake::spectral {

/// A part of a step. The order of the stages and the equation that they solve together are those of
/// Stepper (stepper.hpp).
class Stage {
public:
    explicit Stage(StepState& state) : s_(state) {}
    virtual ~Stage() = default;
    Stage(const Stage&) = delete;
    Stage& operator=(const Stage&) = delete;

    /// Throws CaseFailure or FieldDiverges on all ranks together. Collective.
    virtual void advance() = 0;
    /// What this rank has allocated for the stage, under the names of SpectralPlan::resources().
    /// Not collective.
    virtual std::vector<engines::Allocation> arrays() const = 0;
    /// Save and restore what the stage carries from step to step. Collective.
    virtual void save(StateWriter& state) const = 0;
    virtual void restore(const StateReader& state) = 0;

protected:
    StepState& s_;
};

// The state must outlive the stages. Their allocations throw CaseFailure on all ranks together.
// Collective.

/// What a run passes to its observer (output_stage.cpp): u_z at the measured depths for each frame,
/// the displacement of each snapshot, and strain and stress, which need the step after the frame or
/// snapshot: `advance` saves what that step overwrites.
class OutputStage : public Stage {
public:
    using Stage::Stage;
    /// Passes the strain and stress at the start of the last step. Collective.
    virtual void emit_earlier(engines::Observer& observer) = 0;
    /// In addition passes the frame and the snapshot at its end. Collective.
    virtual void emit(engines::Observer& observer) = 0;
    /// Whether strain or stress at the current time need one more step. Not collective.
    virtual bool needs_next_step() const = 0;
};
/// `per_frame`: number of steps of a frame.
std::unique_ptr<OutputStage> make_output(StepState& state, std::ptrdiff_t per_frame);
/// A component of the displacement [m] (0: x, 1: y, 2: z) at a depth as rows of the transposed
/// spectrum, in the layout of SlabTransform. Not collective.
void put_plane(const StepState& state, std::size_t component, DepthWeights at, double* plane);

/// Removes a share of the velocity in the margin of the domain (sponge_stage.cpp).
class Sponge : public Stage {
public:
    using Stage::Stage;
    /// Whether it leaves the pencils of this step to the pass of the next stage, when their factors
    /// are in the cache. Not collective.
    bool acts_in_pass() const { return s_.is_uniform() && s_.sponge_acts_at(s_.step); }
    /// Damps a pencil in this pass, before the step advances it. Not collective.
    virtual void damp_in_pass(const Pencil& p) = 0;
};
std::unique_ptr<Sponge> make_sponge(StepState& state);
/// The pass over the pencils with the explicit forces (pencil_stage.cpp).
std::unique_ptr<Stage> make_pencils(StepState& state, Sponge& sponge);
/// The kinetic energy and the work of the load, which must account for it (energy_stage.cpp).
std::unique_ptr<Stage> make_energy(StepState& state);
/// The forces that make the markers of the rigid bodies move rigidly (constraint_stage.cpp).
std::unique_ptr<Stage> make_constraint(StepState& state);
/// The stress of elastic bodies at the next step, on complete planes (variation_stage.cpp).
std::unique_ptr<Stage> make_variation(StepState& state);
/// Instead of pencils and variation, where a box contains the elastic bodies (box_stage.cpp).
struct BoxStages {
    std::unique_ptr<Stage> pencils, variation;
};
BoxStages make_box_stages(StepState& state, const BoxGrid& grid);

/// The energy that the scheme preserves (energy_stage.cpp), half a step before the current time,
/// and the work of the load so far.
struct EnergyBalance {
    double energy_J = 0.0, work_J = 0.0;
};
/// Exact up to rounding and the residual of iterations. Costs about one step and overwrites the
/// work arrays of a step. Throws FieldDiverges on all ranks together if the field diverges.
/// Collective.
EnergyBalance energy_of(StepState& state);

/// Conjugate gradients for the strain of a step, which both treatments of elastic bodies share
/// (variation_stage.cpp).
class StrainIteration {
public:
    explicit StrainIteration(StepState& state);
    /// On entry state.change is E B^-1 rhs, on return e = E d. Returns the number of iterations;
    /// if there were any, stress() is S e. Collective.
    int solve(const StrainSolver::Responses& respond);
    const StepState::Values& stress() { return solver_->stress(); }
    /// Replaces the previous strain by the next one. Not collective.
    void advance_strains();

    std::vector<engines::Allocation> arrays() const;
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

private:
    StepState& s_;
    const StrainKernels& kernels_;
    std::optional<StrainSolver> solver_; // empty unless steps iterate
};

} // namespace shearwake::spectral
