// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_engine.hpp"

#include "base/error.hpp"
#include "engines/march.hpp"
#include "engines/spectral/spectral_plan.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>

namespace shearwake::spectral {
namespace {

/// The lateral variation as the stepper treats it.
VariationPlan treated_variation(const Stepper& stepper) {
    const LateralVariation& v = stepper.field().variation();
    return {.points = static_cast<double>(v.strain_points.size()),
            .iterates = v.iterates,
            .why = v.why,
            .box = stepper.box()};
}

} // namespace

const SpectralPlan& SpectralEngine::plan_of(const Case& given, engines::ChoiceLimit limit) const {
    constexpr std::size_t most = 16; // `plan` needs those of twelve cases twice
    for (const Planned& known : planned_)
        if (known.given == given) return known.plan;
    if (planned_.size() == most) planned_.pop_front();
    return planned_.emplace_back(Planned{given, SpectralPlan(given, limit)}).plan;
}

const SampledVariation& SpectralEngine::variation_of(const SpectralPlan& plan) const {
    static const SampledVariation none;
    const Medium& medium = plan.rigid.c.scene.medium;
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
    const auto& [rigid, time, mesh] = plan;
    const Case& c = rigid.c;
    const auto& options = std::get<SpectralOptions>(c.solver);
    constexpr double most_probed = 1e4; // steps times elements: about 0.3 s
    const double probed =
        static_cast<double>(steps_to_probe(c, time.step_s)) * static_cast<double>(mesh.elements());
    std::optional<ProbedErrors> errors;
    if (probed <= most_probed) errors = probed_errors(c, options, time.step_s);
    return plan.notes(errors, plan.variation(variation_of(plan), 1));
}

engines::StepRefinement SpectralEngine::refine_time_step(const Case& c) const {
    auto options = std::get<SpectralOptions>(c.solver);
    const double before = options.accuracy;
    if (options.time_step_s || before < 2.0 * SpectralOptions::least_accuracy) {
        const double step_s = 0.5 * options.time_step_s.value_or(plan_of(c).time.step_s);
        options.time_step_s = step_s;
        return {.options = options,
                .change = fmt::format("half the time step, {:.4g} us", 1e6 * step_s)};
    }
    options.accuracy = std::max(0.25 * before, SpectralOptions::least_accuracy);
    return {.options = options,
            .change = fmt::format("{:.3g} of the tolerance (accuracy {:.3g})",
                                  options.accuracy / before, options.accuracy),
            .ratio = std::sqrt(before / options.accuracy)}; // the error grows with its square
}

void SpectralEngine::run(const Case& given, const Comm& team, engines::Observer& observer,
                         engines::Checkpoints* checkpoints) {
    const SpectralPlan plan = plan_of(given); // a copy, since an observer may ask for other plans
    const auto& [rigid, time, mesh] = plan;
    const Case& c = rigid.c;
    const auto& options = std::get<SpectralOptions>(c.solver);
    const ProbedErrors errors = probed_errors(c, options, time.step_s); // its memory is released
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, team, fft::Planning::measured);
    Stepper stepper(rigid, mesh, slabs, time.step_s, team, time.per_frame);
    observer.begin({slabs.share().x_start, slabs.share().x_count});
    if (!c.record.volumes_s.empty()) observer.volume_levels(mesh.clear_levels_m());
    if (engines::march(stepper, plan.steps(), observer, checkpoints) == engines::MarchEnd::stopped)
        return;
    const StepStatistics& s = stepper.statistics();
    const EnergyBalance balance = stepper.energy(); // also checks for divergence a last time
    const engines::SolverReport report = {.notes = plan.notes(errors, treated_variation(stepper)),
                                          .steps = s.steps,
                                          .iterations = s.iterations,
                                          .most_iterations = s.most_iterations,
                                          .work_J = balance.work_J,
                                          .energy_J = balance.energy_J,
                                          .warnings = accuracy_warnings(c, errors)};
    stepper.finish(observer);
    observer.solved(report);
}

} // namespace shearwake::spectral
