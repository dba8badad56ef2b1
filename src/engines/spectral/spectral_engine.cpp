// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_engine.hpp"

#include "base/error.hpp"
#include "engines/march.hpp"
#include "engines/spectral/choices.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "engines/spectral/tensor_volumes.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace shearwake::spectral {
namespace {

/// Runs a case of the engine "spectral": u_z at the measured depths for each frame; displacement,
/// strain and stress for each snapshot; and the stress at receptors. Strain and stress need the
/// step after the frame or snapshot.
class SpectralMarch : public engines::Marching {
public:
    /// Throws CaseFailure on all ranks together. Collective.
    SpectralMarch(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                  const TimeStep& time, const Comm& team);

    std::ptrdiff_t step() const override { return stepper_.step(); }
    void advance() override;
    void give(engines::Observer& observer) override;
    void save(StateWriter& state) const override { stepper_.save(state); }
    void restore(const StateReader& state) override { stepper_.restore(state); }

    /// Depths of the levels of volumes.
    const std::vector<double>& levels_m() const { return levels_m_; }
    /// To be called after the last step: takes one more step if the strain or stress at its end is
    /// required. Collective.
    void finish(engines::Observer& observer);
    Stepper& stepper() { return stepper_; }

private:
    /// The snapshot at the end of a step, if any.
    std::optional<std::size_t> snapshot(std::ptrdiff_t step) const;
    void give_frame(std::ptrdiff_t number, engines::Observer& observer);
    void give_displacement(std::size_t snapshot, std::size_t field, engines::Observer& observer);
    void give_earlier(engines::Observer& observer);
    View2<const double> plane() const;

    const Case& case_;
    Case layers_; // and elastic bodies: those whose material the tensors need
    const fft::SlabTransform& slabs_;
    std::ptrdiff_t per_frame_;
    Stepper stepper_;
    InsideBodies inside_;
    TensorVolumes tensors_;
    ReceptorStress receptors_;
    std::vector<double> levels_m_;
    fft::AlignedVector<double> plane_;
    // Output that refers to the start of the last step: the tensors of a snapshot, the stress of a
    // frame.
    std::optional<std::size_t> remembered_snapshot_;
    std::optional<std::ptrdiff_t> remembered_frame_;
};

SpectralMarch::SpectralMarch(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                             const TimeStep& time, const Comm& team)
    : case_(c), layers_(without_rigid_bodies(c)), slabs_(slabs), per_frame_(time.per_frame),
      stepper_(c, mesh, slabs, time.step_s, team), inside_(c, slabs.share()),
      tensors_(layers_, mesh, slabs, time.step_s, team, &stepper_.bodies()),
      receptors_(layers_, stress_depths_m(c), mesh, slabs, time.step_s, team, &stepper_.bodies()) {
    for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
        levels_m_.push_back(mesh.z_m(level));
    together(team, [&] { plane_.resize(static_cast<std::size_t>(slabs.share().reals)); });
}

std::optional<std::size_t> SpectralMarch::snapshot(std::ptrdiff_t step) const {
    if (step % per_frame_ != 0) return {};
    return engines::snapshot_at(case_, step / per_frame_);
}

void SpectralMarch::advance() {
    const std::ptrdiff_t began = stepper_.step();
    if (tensors_.wanted()) remembered_snapshot_ = snapshot(began);
    if (receptors_.wanted() && began > 0 && began % per_frame_ == 0)
        remembered_frame_ = began / per_frame_ - 1;
    if (remembered_snapshot_) tensors_.remember(stepper_);
    if (remembered_frame_) receptors_.remember(stepper_.before().data());
    stepper_.advance();
}

void SpectralMarch::give(engines::Observer& observer) {
    give_earlier(observer);
    const std::ptrdiff_t step = stepper_.step();
    if (step % per_frame_ == 0) give_frame(step / per_frame_ - 1, observer);
    const auto& kept = case_.record.volume_fields;
    const auto u = std::find(kept.begin(), kept.end(), VolumeField::u);
    if (const auto now = snapshot(step); now && u != kept.end())
        give_displacement(*now, static_cast<std::size_t>(u - kept.begin()), observer);
}

/// Passes the output that refers to the start of the last step.
void SpectralMarch::give_earlier(engines::Observer& observer) {
    if (remembered_snapshot_) tensors_.give(stepper_, inside_, *remembered_snapshot_, observer);
    if (remembered_frame_)
        receptors_.give({stepper_.before().data(), stepper_.now().data()},
                        stepper_.bodies().step_forces(), *remembered_frame_, observer);
    remembered_snapshot_.reset();
    remembered_frame_.reset();
}

void SpectralMarch::give_frame(std::ptrdiff_t number, engines::Observer& observer) {
    for (std::size_t depth = 0; depth < case_.measure.depths_m.size(); ++depth) {
        stepper_.plane_of_w(case_.measure.depths_m[depth], plane_.data());
        slabs_.to_physical(plane_.data());
        observer.frame({.number = number, .depth = depth, .u_z_m = plane()});
    }
}

void SpectralMarch::give_displacement(std::size_t snapshot, std::size_t field,
                                      engines::Observer& observer) {
    for (std::size_t component = 0; component < 3; ++component)
        for (std::size_t level = 0; level < levels_m_.size(); ++level) {
            stepper_.plane_of_u(component, level, plane_.data());
            slabs_.to_physical(plane_.data());
            inside_.set_displacement(levels_m_[level], component, stepper_.bodies().motions(),
                                     plane_.data());
            observer.volume({.snapshot = snapshot,
                             .field = field,
                             .component = component,
                             .level = level,
                             .values = plane()});
        }
}

View2<const double> SpectralMarch::plane() const {
    const fft::SlabShare& share = slabs_.share();
    return {plane_.data(), share.x_count, case_.domain.ny, share.padded_ny};
}

void SpectralMarch::finish(engines::Observer& observer) {
    if (!receptors_.wanted() && !(tensors_.wanted() && snapshot(stepper_.step()))) return;
    advance();
    give_earlier(observer);
}

/// Collective.
engines::SolverReport report_of(Stepper& stepper, std::vector<std::string> notes) {
    notes.insert(notes.end(), stepper.notes().begin(), stepper.notes().end());
    if (stepper.uses_box()) notes.push_back("iterations take place in a box around the bodies");
    const StepStatistics& s = stepper.statistics();
    const EnergyBalance balance = stepper.energy(); // also checks for divergence a last time
    return {.notes = std::move(notes),
            .steps = s.steps,
            .iterations = s.iterations,
            .most_iterations = s.most_iterations,
            .work_J = balance.work_J,
            .energy_J = balance.energy_J};
}

} // namespace

const SpectralPlan& SpectralEngine::plan_of(const Case& given) const {
    constexpr std::size_t most = 16; // `plan` needs those of twelve cases twice
    for (const Planned& known : planned_)
        if (known.given == given) return known.plan;
    if (planned_.size() == most) planned_.pop_front();
    return planned_.emplace_back(Planned{given, SpectralPlan(given)}).plan;
}

const SampledVariation& SpectralEngine::variation_of(const SpectralPlan& plan) const {
    static const SampledVariation none;
    const Medium& medium = plan.c.scene().medium;
    if (medium.bodies.empty() && !medium.map) return none;
    const std::string key = plan.key_of_variation();
    auto known = variations_.find(key);
    if (known == variations_.end())
        known = variations_.emplace(key, plan.sampled_variation()).first;
    return known->second;
}

engines::Resources SpectralEngine::resources(const Case& c, int ranks) const {
    const SpectralPlan& plan = plan_of(c);
    return plan.resources(variation_of(plan), ranks);
}

std::vector<std::string> SpectralEngine::choices(const Case& given) const {
    const SpectralPlan& plan = plan_of(given);
    const auto& [c, time, mesh, rigid] = plan;
    const auto& options = std::get<SpectralOptions>(c.solver);
    auto notes = discretisation_notes(time, mesh, probed_errors(c, options, time.step_s));
    for (const auto& more :
         {edge_notes(c), body_notes(given), engines::notes_of(variation_choices(c, options))})
        notes.insert(notes.end(), more.begin(), more.end());
    if (!rigid.why.empty()) notes.push_back(rigid.why);
    if (const VariationPlan varying = plan.variation(variation_of(plan), 1); varying.points > 0.0)
        notes.push_back(varying.note());
    return notes;
}

engines::StepRefinement SpectralEngine::half_the_step(const Case& c) const {
    auto options = std::get<SpectralOptions>(c.solver);
    constexpr double order = 2.0;
    const double before = options.accuracy;
    if (options.time_step_s || before < 2.0 * SpectralOptions::least_accuracy) {
        const double step_s = 0.5 * options.time_step_s.value_or(probed_step_s(c));
        options.time_step_s = step_s;
        return {.options = options,
                .change = fmt::format("half the time step, {:.4g} us", 1e6 * step_s),
                .order = order};
    }
    options.accuracy = std::max(0.25 * before, SpectralOptions::least_accuracy);
    return {.options = options,
            .change = fmt::format("{:.3g} of the tolerance (accuracy {:.3g})",
                                  options.accuracy / before, options.accuracy),
            .ratio = std::sqrt(before / options.accuracy), // the error grows with the step squared
            .order = order};
}

void SpectralEngine::run(const Case& given, const Comm& team, engines::Observer& observer,
                         engines::Checkpoints* checkpoints) {
    const auto began = Clock::now();
    const SpectralPlan plan = plan_of(given); // a copy, since an observer may ask for other plans
    const auto& [c, time, mesh, rigid] = plan;
    const auto& options = std::get<SpectralOptions>(c.solver);
    const ProbedErrors errors = probed_errors(c, options, time.step_s); // its memory is released
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, team, fft::Planning::measured);
    SpectralMarch field(c, mesh, slabs, time, team);
    observer.begin({slabs.share().x_start, slabs.share().x_count});
    if (!c.record.volumes_s.empty()) observer.volume_levels(field.levels_m());
    if (engines::march(field, plan.steps(), observer, checkpoints, plan.work(), began) ==
        engines::MarchEnd::stopped)
        return;
    auto notes = discretisation_notes(time, mesh, errors);
    for (const auto& more : {edge_notes(c), body_notes(given)})
        notes.insert(notes.end(), more.begin(), more.end());
    if (!rigid.why.empty()) notes.push_back(rigid.why);
    engines::SolverReport report = report_of(field.stepper(), std::move(notes));
    report.warnings = accuracy_warnings(c, errors);
    field.finish(observer);
    observer.solved(report);
}

} // namespace shearwake::spectral
