// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "pipeline/afferent_result.hpp"
#include "support/cases.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <stdexcept>

namespace test_afferents {

using namespace shearwake;

static const Variable& variable(const pipeline::AfferentResult& result, const std::string& name) {
    for (const Variable& v : result.groups.at(0).variables)
        if (v.name == name) return v;
    throw std::runtime_error("no variable " + name);
}

static pipeline::ReceptorMotion vibration() {
    pipeline::ReceptorMotion motion{
        .pins = {.rate_Hz = 20000.0}, .modulation_Hz = 200.0, .name = "a case"};
    motion.path_m = {{}};
    for (int p = 0; p < 2; ++p) {
        std::vector<double>& u_m = motion.pins.u_m.emplace_back();
        for (int k = 0; k < 1000; ++k)
            u_m.push_back(20e-6 * (1.0 - std::cos(2.0 * M_PI * 200.0 * k / 20000.0)));
    }
    return motion;
}

TEST_CASE("spikes with noise are identical on any number of ranks", "[mpi][neural]") {
    const Comm world = Comm::world();
    AfferentOptions options;
    options.noise = Switch::on;
    options.pins_m = {{-3e-3, 0.0}, {3e-3, 0.0}};
    const neural::Scene scene = neural::make_scene(options);
    const pipeline::AfferentResult shared =
        pipeline::simulate_afferents(vibration(), options, scene, world);
    const pipeline::AfferentResult alone =
        pipeline::simulate_afferents(vibration(), options, scene, world.split(world.rank()));
    // Every rank computes all spikes alone. Rank 0 compares, and the result is broadcast.
    long same = 1;
    if (world.is_root())
        same = variable(shared, "spike_time").values == variable(alone, "spike_time").values &&
               variable(shared, "spike_count").values == variable(alone, "spike_count").values &&
               variable(shared, "spike_time").values.size() > 100;
    CHECK(world.broadcast(same) == 1);
    CHECK(alone.columns.size() == 3 * 10);
}

TEST_CASE("throws an error in the pins on all ranks", "[mpi][neural]") {
    const Comm world = Comm::world();
    AfferentOptions options;
    options.pins_m = {{1.0, 0.0}, {1.1, 0.0}}; // one metre outside of the hand
    const neural::Scene scene = neural::make_scene(options);
    CHECK_THROWS_AS(pipeline::simulate_afferents(vibration(), options, scene, world), CaseFailure);
}

} // namespace test_afferents
