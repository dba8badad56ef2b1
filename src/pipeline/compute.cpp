// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/compute.hpp"

#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"

namespace shearwake::pipeline {
namespace {

/// Collective.
CaseResults case_results(const PlannedCase& planned, const SurfaceRecorder& recorder,
                         const std::shared_ptr<const neural::Scene>& receptors, const Comm& team) {
    const Case& c = planned.physics;
    AfferentResult afferents;
    if (receptors)
        afferents = simulate_afferents(receptor_motion(planned, recorder, *receptors), *c.afferents,
                                       *receptors, team);
    CaseResults results{.solver = recorder.solver(),
                        .afferents = afferents.notes,
                        .groups = {},
                        .mean_u2 = recorder.mean_u2(),
                        .surface = {}};
    on_root(team, [&] {
        results.surface = recorder.depths().front().frames;
        results.groups = case_content(c, recorder, std::move(afferents));
    });
    return results;
}

} // namespace

std::optional<CaseResults> compute(const PlannedCase& planned, const CasePlan& plan,
                                   engines::FrameSource& engine, const Comm& team,
                                   const Sinks& sinks) {
    const Case& c = planned.physics;
    std::optional<CaseResults> results;
    fail_together(team, [&] {
        SurfaceRecorder recorder(c, team, sinks);
        record_receptors(c, plan.receptors, recorder);
        engine.run(c, team, recorder, sinks.checkpoints);
        if (sinks.checkpoints && sinks.checkpoints->stop()) return;
        recorder.finish();
        const Comm::Unwatched writing;
        results = case_results(planned, recorder, plan.receptors, team);
    });
    return results;
}

} // namespace shearwake::pipeline
