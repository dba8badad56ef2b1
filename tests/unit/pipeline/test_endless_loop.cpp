// SPDX-License-Identifier: BSD-3-Clause
// Receptors under a motion that has always repeated.
#include "pipeline/afferent_result.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

namespace test_endless_loop {

using namespace shearwake;
using namespace shearwake::pipeline;

constexpr double rate_Hz = 16000.0, period_s = 20e-3;
constexpr std::size_t samples = 320; // of a period

/// Every neuron of every class, 3 mm from the pin.
static AfferentOptions all_neurons(AfferentInput input) {
    AfferentList list;
    for (const AfferentClass kind : all_classes)
        for (std::size_t row = 0; row < neural::neuron_rows(kind).size(); ++row)
            list.all.push_back({{3e-3, 0.0}, kind, row});
    AfferentOptions options{.places = list, .sheet = SkinSheet::flat, .input = input};
    return options;
}

/// An indentation of 50 Hz and its harmonics about a mean, beginning `shift` samples later.
static std::vector<double> one_period(double amplitude, std::size_t shift) {
    std::vector<double> line;
    for (std::size_t k = 0; k < samples; ++k) {
        const double phase = 2.0 * std::numbers::pi * static_cast<double>(k + shift) / samples;
        line.push_back(amplitude * (1.5 + std::cos(phase) + 0.4 * std::sin(2.0 * phase) +
                                    0.2 * std::cos(4.0 * phase)));
    }
    return line;
}

static ReceptorMotion repeating(const AfferentOptions& options, std::size_t counted,
                                std::size_t shift = 0) {
    ReceptorMotion motion{.pins = {.rate_Hz = rate_Hz}, .modulation_Hz = 50.0, .name = "a case"};
    const auto afferents = neural::make_scene(options).afferents;
    motion.repetitions = neural::repetitions_of(afferents, period_s, counted);
    motion.path_m = {{}};
    if (std::holds_alternative<StressInput>(options.input))
        motion.compression_Pa.assign(afferents.size(), one_period(4000.0, shift));
    else
        motion.pins.u_m = {one_period(150e-6, shift)};
    return motion;
}

static AfferentResult felt_alone(const ReceptorMotion& motion, const AfferentOptions& options) {
    return simulate_afferents(motion, options, neural::make_scene(options),
                              Comm::world().split(Comm::world().rank()));
}

static std::vector<double> values(const AfferentResult& result, const std::string& name) {
    for (const Variable& v : result.groups.at(0).variables)
        if (v.name == name) return v.values;
    throw std::runtime_error("no variable " + name);
}

static std::vector<double> counts(const AfferentOptions& options, std::size_t counted,
                                  std::size_t shift = 0) {
    return values(felt_alone(repeating(options, counted, shift), options), "spike_count");
}

static const measures::Column& column(const AfferentResult& result, const std::string& name) {
    for (const measures::Column& c : result.columns)
        if (c.name == name) return c;
    throw std::runtime_error("no column " + name);
}

TEST_CASE("spikes per period do not depend on the number of periods of an endless loop",
          "[neural][periodic]") {
    const AfferentInput input = GENERATE(AfferentInput{PinInput{}}, AfferentInput{StressInput{}});
    const AfferentOptions options = all_neurons(input);
    const std::vector<double> of_eight = counts(options, 8), of_forty = counts(options, 40);
    CHECK(std::ranges::count_if(of_eight, [](double n) { return n >= 4.0; }) > 8);
    std::size_t locked = 0;
    for (std::size_t i = 0; i < of_eight.size(); ++i) {
        INFO("afferent " << i);
        // Neurons whose pattern repeats within two periods: no spike of the beginning is counted.
        const bool repeats = of_forty[i] > 0.0 && std::fmod(of_forty[i], 20.0) == 0.0;
        locked += repeats ? 1 : 0;
        // The pattern of others repeats after several periods (one fires in every fifth), so that
        // the end of the counted time decides on a spike in each count.
        const double spikes = repeats ? 0.0 : 1.0;
        CHECK(std::abs(of_forty[i] / 40.0 - of_eight[i] / 8.0) <=
              spikes * (1.0 / 40.0 + 1.0 / 8.0) + 1e-12);
    }
    CHECK(2 * locked > of_eight.size());
    // Nor on the phase at which the loop is cut, except for neurons that can fire in two stable
    // ways, between which the past decides: one of 17 fires four or five times per period.
    const std::vector<double> shifted = counts(options, 8, 123);
    std::size_t other = 0;
    for (std::size_t i = 0; i < of_eight.size(); ++i)
        other += std::abs(shifted[i] - of_eight[i]) > 1.0 ? 1 : 0;
    CHECK(other <= 1);
}

TEST_CASE("receptors state the counted periods of an endless loop and have no first spike",
          "[neural][periodic]") {
    const AfferentOptions options = all_neurons(PinInput{});
    ReceptorMotion motion = repeating(options, 8);
    const AfferentResult result = felt_alone(motion, options);
    CHECK(result.notes.empty()); // the motion does not begin, so it begins with no step
    CHECK(column(result, "receptor_periods_1").value == 8.0);
    CHECK(column(result, "receptor_run_in_periods_1").value == 38.0); // 0.74 s for SA1
    const measures::Column first = column(result, "PC_first_spike_ms");
    CHECK(std::isnan(first.value));
    CHECK(first.note == "the motion has always repeated, so that no spike is the first");
    for (const double t_s : values(result, "spike_time"))
        CHECK((t_s > 0.0 && t_s <= 8 * period_s + 1e-9));
    // The same motion that begins at t = 0 makes neurons fire at once.
    motion.repetitions = {};
    const AfferentResult once = felt_alone(motion, options);
    CHECK(column(once, "PC_first_spike_ms").value < 2.0);
    CHECK(once.notes.size() == 1);
}

TEST_CASE("a run-in lasts eight time constants of the slowest membrane", "[neural][periodic]") {
    using neural::Afferent;
    const std::vector<Afferent> slow = {{{}, AfferentClass::PC, 0}, {{}, AfferentClass::SA1, 3}},
                                fast = {{{}, AfferentClass::PC, 0}};
    // SA1 of row 3: 408.9 samples of 0.2 ms; 38 ms of currents after a spike; 50 ms of travel.
    CHECK(neural::run_in_s(slow) == Approx(8 * 408.9069 * 0.2e-3 + 88e-3).epsilon(1e-6));
    CHECK(neural::run_in_s(fast) < 0.11);
    CHECK(neural::repetitions_of(slow, 2.0, 3).run_in == 1);
    CHECK(neural::repetitions_of(slow, 2.0, 3).total() == 5);
    CHECK(neural::repetitions_of(fast, 1e-3, 10).run_out == 10);
}

} // namespace test_endless_loop
