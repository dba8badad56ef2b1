// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_results.hpp"

#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/case_content.hpp"
#include "pipeline/vibrometer.hpp"

namespace shearwake::pipeline {

CaseResults case_results(const PlannedCase& planned, const SurfaceRecorder& recorder,
                         const Comm& team) {
    const Case& c = planned.physics;
    AfferentResult afferents;
    if (c.afferents) afferents = felt(felt_motion(planned, recorder), *c.afferents, team);
    CaseResults results;
    on_root(team, [&] {
        results.groups = case_content(c, recorder.depths(), recorder.traces(), recorder.mach(),
                                      recorder.mean_u2());
        add_columns(energy_columns(recorder.solver()), results.groups.front());
        add_columns(afferents.columns, results.groups.front());
        for (VariableGroup& group : afferents.groups)
            results.groups.push_back(std::move(group));
        if (c.vibrometer) results.groups.push_back(vibrometer_group(c, recorder.scan_m()));
        if (!recorder.solver().sensors.empty())
            results.groups.push_back(sensor_group(*c.study(), recorder.solver().sensors));
    });
    results.afferents = std::move(afferents.notes);
    return results;
}

} // namespace shearwake::pipeline
