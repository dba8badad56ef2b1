// SPDX-License-Identifier: BSD-3-Clause
// jobs/fig2.7.toml: receptors respond when the focus passes.
#include "config/job.hpp"
#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/surface_recorder.hpp"
#include "storage/files.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

namespace test_neural_scan {

using namespace shearwake;

static const std::vector<double>& values(const VariableGroup& group, std::string_view name) {
    for (const Variable& v : group.variables)
        if (v.name == name) return v.values;
    throw std::runtime_error("no variable " + std::string(name));
}

TEST_CASE("first spikes along a scan are delayed by the travel time of the focus", "[neural]") {
    const std::filesystem::path& folder = test::jobs_folder;
    const config::Job job = config::read_job(
        storage::read_file(folder / "fig2.7.toml"), "fig2.7.toml", {}, nullptr,
        [&](const std::string& file) { return storage::read_file(folder / file); });
    REQUIRE(job.plan.cases.size() == 1);
    const PlannedCase& planned = job.plan.cases.front();
    const Case& c = planned.physics;
    const Comm alone = Comm::world().split(Comm::world().rank());
    pipeline::SurfaceRecorder recorder(c, alone, {});
    engines::make_engine(c.solver)->run(c, alone, recorder);
    recorder.finish();
    const neural::Scene scene = neural::make_scene(*c.afferents);
    const pipeline::AfferentResult result = pipeline::simulate_afferents(
        pipeline::receptor_motion(planned, recorder, scene), *c.afferents, scene, alone);

    const VariableGroup& group = result.groups.at(0);
    const auto &counts = values(group, "spike_count"), &times_s = values(group, "spike_time"),
               &kinds = values(group, "class"), &rows = values(group, "row");
    constexpr std::size_t places = 5, neurons = 17;
    REQUIRE(counts.size() == places * neurons);
    std::vector<double> first_s(counts.size(), NAN);
    std::size_t at = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        if (counts[i] > 0.0) first_s[i] = times_s[at];
        at += static_cast<std::size_t>(counts[i]);
    }
    const double expected_s = 15e-3 / 2.5;
    for (std::size_t place = 1; place < places; ++place)
        for (std::size_t n = 0; n < neurons; ++n) {
            const std::size_t i = place * neurons + n;
            // Other Pacinian neurons respond to waves that precede the focus.
            const bool insensitive =
                kinds[i] == static_cast<double>(AfferentClass::PC) && rows[i] == 2.0;
            if (kinds[i] != static_cast<double>(AfferentClass::RA) && !insensitive) continue;
            CAPTURE(place, n);
            // One sample of the neurons is 0.2 ms, 3 %; waves from other positions contribute to
            // each spike time.
            CHECK(first_s[i] - first_s[i - neurons] == Approx(expected_s).epsilon(0.10));
        }
}

} // namespace test_neural_scan
