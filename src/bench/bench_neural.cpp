// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "bench/bench.hpp"
#include "neural/hand/scene.hpp"
#include "neural/respond.hpp"
#include "neural/skin/resample.hpp"
#include "pipeline/memory.hpp"

#include <cmath>
#include <ctime>
#include <fmt/format.h>

namespace shearwake::bench {
namespace {

using namespace neural;

/// 5 x 5 pins, 4 mm apart in the palm, vibrating at 200 Hz for 1 s, each with a different phase.
PinStimulus grid_of_pins() {
    PinStimulus stimulus{.radius_mm = 1.0, .rate_Hz = neuron_rate_Hz};
    stimulus.indentation_mm = Lines(25, 5000);
    for (std::size_t p = 0; p < 25; ++p) {
        const Vec2 cell = {static_cast<double>(p % 5), static_cast<double>(p / 5)};
        stimulus.at_mm.push_back(Vec2{118.0, 2.0} + 4.0 * cell);
        for (std::size_t k = 0; k < 5000; ++k)
            stimulus.indentation_mm.line(p)[k] =
                0.05 * (1.0 + std::sin(two_pi * 200.0 * static_cast<double>(k) / neuron_rate_Hz +
                                       static_cast<double>(p)));
    }
    return stimulus;
}

void time_one(const Comm& world, Output& out, const std::string& what, const PinStimulus& stimulus,
              const std::vector<Afferent>& afferents, RespondOptions options) {
    std::size_t spikes = 0;
    const double seconds = best_of(3, [&] {
        const std::clock_t began = std::clock(); // CPU time, which other processes disturb less
        options.ways = ways_within(make_hand().outline_mm, stimulus.at_mm);
        spikes = 0;
        for (const Spikes& train : respond(stimulus, afferents, options))
            spikes += train.size();
        return world.max(static_cast<double>(std::clock() - began) / CLOCKS_PER_SEC);
    });
    if (world.is_root()) out.add(what, seconds, "s");
    if (world.is_root())
        out.print("  {:<44} {:8.3f} s   {} afferents, {} spikes\n", what, seconds, afferents.size(),
                  spikes);
}

} // namespace

ExitCode bench_neural(const Comm& world, Output& out) {
    const Hand hand = make_hand();
    const std::vector only_PC = {AfferentClass::PC};
    const PinStimulus pins = grid_of_pins();
    if (world.is_root())
        out.print("response of the nerve fibres of a hand during 1 s; every rank computes all "
                  "fibres; CPU seconds\n");
    time_one(world, out, "PC, 25 pins at 5 kHz", pins, populate(hand.regions, only_PC, 1), {});
    const auto all = populate(hand.regions, all_classes, 1);
    time_one(world, out, "all classes, 25 pins at 5 kHz", pins, all, {});
    time_one(world, out, "all classes, 25 pins at 5 kHz, with noise", pins, all, {.noise_key = 1});

    const CarrierInput carrier{.amplitude_m = 50e-6, .am_frequency_Hz = 200.0, .am_depth = 1.0};
    const PinStimulus fast = carrier_stimulus(carrier, {{126.0, 10.0}}, 1.0, 1.0);
    const auto palm = populate(region(hand, "palm"), AfferentClass::PC, 1);
    time_one(world, out, "PC of the palm, one pin at 200 kHz", fast, palm, {});
    if (world.is_root())
        out.print("  peak memory of this process {:>15.0f} MB\n", pipeline::peak_memory_B() / 1e6);
    return ExitCode::done;
}

} // namespace shearwake::bench
