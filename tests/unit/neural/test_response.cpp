// SPDX-License-Identifier: BSD-3-Clause
#include "neural/response.hpp"

#include "base/error.hpp"
#include "neural/skin/stimulus.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace test_response {

using namespace shearwake;
using namespace shearwake::neural;

static PinStimulus tapping(std::vector<Vec2> at_mm, double rate_Hz = 5000.0) {
    PinStimulus s{.at_mm = std::move(at_mm), .radius_mm = 1.0, .rate_Hz = rate_Hz};
    const auto samples = static_cast<std::size_t>(0.1 * rate_Hz);
    s.indentation_mm = Lines(s.at_mm.size(), samples);
    for (std::size_t p = 0; p < s.at_mm.size(); ++p)
        for (std::size_t k = 0; k < samples; ++k)
            s.indentation_mm.line(p)[k] =
                0.05 * (1.0 - std::cos(2.0 * M_PI * 200.0 * static_cast<double>(k) / rate_Hz));
    return s;
}

/// Of half a second, at this modulation, with all fibres on the path.
static std::vector<ClassResponse> responses_at(double f_Hz, const std::vector<Afferent>& afferents,
                                               const SpikeTimes& times_s, double duration_s = 0.5) {
    return class_responses(afferents, times_s, duration_s, f_Hz, 1.0, [](Vec2) { return 0.0; });
}

static std::string words(const std::vector<Remark>& remarks) {
    std::string all;
    for (const Remark& r : remarks)
        all += (r.severity == Severity::error ? "error: " : "warning: ") + r.key + ": " +
               r.message + "\n";
    return all;
}

TEST_CASE("adds silence before the stimulus and fades out its last value", "[neural]") {
    Lines lines(1, 4);
    lines.values = {1.0, 2.0, 3.0, 4.0};
    const SilencedLines out = with_silence(lines, 1000.0, 2e-3);
    CHECK(out.before_s == 2e-3);
    const auto& values = out.lines.values;
    REQUIRE(values.size() == 8);
    CHECK(std::vector(values.begin(), values.begin() + 6) ==
          std::vector{0.0, 0.0, 1.0, 2.0, 3.0, 4.0});
    CHECK(values[6] == Approx(2.0).epsilon(1e-14)); // cos^2(pi/4)
    CHECK(values[7] == 0.0);
    CHECK(with_silence(lines, 1000.0, 0.0).lines == lines);
}

TEST_CASE("a stimulus with silence lasts an integer number of neuron samples", "[neural]") {
    const double rate_Hz = GENERATE(1000.0, 16000.0, 20000.0, 48000.0, 44100.0);
    const auto samples =
        with_silence(tapping({{}}, rate_Hz).indentation_mm, rate_Hz, 0.02).lines.samples;
    const double neuron_samples = static_cast<double>(samples) / rate_Hz * 5000.0;
    CHECK(std::abs(neuron_samples - std::round(neuron_samples)) < 1e-6); // tolerance of the code
}

TEST_CASE("silence only delays the response to a stimulus at the neurons' rate", "[neural]") {
    AfferentOptions options;
    options.classes = {AfferentClass::PC};
    const neural::Scene scene = make_scene(options);
    PinStimulus stimulus = tapping({{126.0, 10.0}});
    for (std::size_t k = 0; k < 25; ++k) // at rest at both ends
        stimulus.indentation_mm.values[k] = stimulus.indentation_mm.values[475 + k] = 0.0;
    // Except for the last sample, which has no successor without silence.
    const auto but_the_last = [&] {
        SpikeTimes times_s = response_to_pins(stimulus, scene, 0, 500, options, 1);
        for (std::vector<double>& train : times_s)
            std::erase_if(train, [](double t_s) { return t_s > 0.0999; });
        return times_s;
    };
    const SpikeTimes silent = but_the_last();
    options.silence_s = 0.0;
    const SpikeTimes bare = but_the_last();
    std::size_t spikes = 0;
    for (std::size_t i = 0; i < bare.size(); ++i) {
        REQUIRE(silent[i].size() == bare[i].size());
        spikes += bare[i].size();
        for (std::size_t k = 0; k < bare[i].size(); ++k)
            CHECK(silent[i][k] == Approx(bare[i][k]).margin(1e-9)); // rounding
    }
    CHECK(spikes > 100);
}

TEST_CASE("spikes of a scene with noise do not depend on its division into parts",
          "[neural][slow]") {
    AfferentOptions options;
    options.noise = Switch::on;
    const neural::Scene scene = make_scene(options);
    const PinStimulus stimulus = tapping({{120.0, 5.0}, {126.0, 10.0}}, 20000.0);
    const std::size_t n = scene.afferents.size();
    const auto whole = response_to_pins(stimulus, scene, 0, n, options, 11);
    SpikeTimes parts;
    for (std::size_t rank = 0; rank < 3; ++rank) {
        const std::size_t first = n * rank / 3, end = n * (rank + 1) / 3;
        for (auto& train : response_to_pins(stimulus, scene, first, end - first, options, 11))
            parts.push_back(std::move(train));
    }
    CHECK(parts == whole);
}

TEST_CASE("adds the conduction delay of each neuron to its spikes", "[neural]") {
    AfferentOptions options;
    options.sheet = SkinSheet::flat;
    options.places = AfferentList{{{{}, AfferentClass::PC, 2}}};
    const neural::Scene scene = make_scene(options);
    const PinStimulus stimulus = tapping({scene.afferents[0].at_mm});
    const auto at_once = response_to_pins(stimulus, scene, 0, 1, options, 1);
    options.conduction_delay = Switch::on;
    const auto later = response_to_pins(stimulus, scene, 0, 1, options, 1);
    REQUIRE(!at_once[0].empty());
    CHECK(later[0][0] - at_once[0][0] == Approx(6.775949651679992e-3).epsilon(1e-12));
}

TEST_CASE("summarises a class by active afferents, rate, spread, locking and first spike",
          "[neural]") {
    const std::vector<Afferent> afferents = {{{3.0, 0.0}, AfferentClass::PC, 0},
                                             {{0.0, 4.0}, AfferentClass::PC, 0},
                                             {{}, AfferentClass::PC, 0},
                                             {{}, AfferentClass::RA, 0}};
    SpikeTimes times_s = {{0.012, 0.022, 0.032, 0.042, 0.052}, {0.0153}, {}, {}};
    const auto of =
        class_responses(afferents, times_s, 0.5, 100.0, 3.5, [](Vec2 at) { return norm(at); });
    REQUIRE(of.size() == 2);
    CHECK(of[0].kind == AfferentClass::RA);
    CHECK(of[0].spikes == 0);
    CHECK(std::isnan(of[0].spread_mm));
    const ClassResponse& PC = of[1];
    CHECK(PC.afferents == 3);
    CHECK(PC.active == 2);
    CHECK(PC.spikes == 6);
    CHECK(PC.mean_rate_Hz == Approx(6.0 / 0.5 / 2.0));
    CHECK(PC.total_rate_Hz == Approx(6.0 / 0.5));
    CHECK(PC.peak_rate_Hz == Approx(6.0 / 0.05)); // from 12 ms until before 62 ms
    CHECK(PC.near_share == Approx(5.0 / 6.0));    // 3 mm and 4 mm from the path
    CHECK(of[0].total_rate_Hz == 0.0);
    CHECK(std::isnan(of[0].near_share));
    CHECK(PC.spread_mm == Approx(std::sqrt((5.0 * 9.0 + 16.0) / 6.0)));
    CHECK(PC.locking == Approx(1.0).epsilon(1e-12)); // 10 ms apart; a single spike is not used
    CHECK(PC.vector_strength == Approx(1.0).epsilon(1e-12));
    CHECK(PC.first_spike_ms == Approx(12.0));
    CHECK(PC.most_spikes == 5);
    // At four times the frequency the phases cancel: 0, 1/4, 1/2, 3/4 of a period, and 0 again.
    times_s[0] = {0.01, 0.0225, 0.035, 0.0475, 0.05, 0.0625, 0.075, 0.0875};
    CHECK(responses_at(100.0, afferents, times_s)[1].locking < 1e-12);
    // Two spikes a quarter of a period apart, in addition to those eight: |1 + i| = sqrt 2,
    // weighted by spikes.
    times_s[1] = {0.010, 0.0125};
    CHECK(responses_at(100.0, afferents, times_s)[1].vector_strength ==
          Approx(std::sqrt(2.0) / 10.0));
    times_s[1].pop_back();
    CHECK(std::isnan(
        responses_at(100.0, afferents, times_s, 0.04)[1].peak_rate_Hz)); // less than 50 ms
    CHECK(std::isnan(responses_at(0.0, afferents, times_s)[1].locking));
}

TEST_CASE("locking is unbiased for small numbers of spikes", "[neural]") {
    // Phases are distributed as 1 + 2 R cos(phi), whose vector strength is R.
    const double R = GENERATE(0.0, 0.4);
    const std::size_t spikes = GENERATE(5u, 20u), fibres = 2000;
    const std::vector<Afferent> afferents(fibres, {{}, AfferentClass::PC, 0});
    std::mt19937 random(1);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    SpikeTimes times_s(fibres);
    for (std::size_t i = 0; i < fibres; ++i) {
        const double own = uniform(random); // later arrival of the wave at this fibre
        while (times_s[i].size() < spikes) {
            const double phase = uniform(random);
            if (uniform(random) * (1.0 + 2.0 * R) < 1.0 + 2.0 * R * std::cos(2.0 * M_PI * phase))
                times_s[i].push_back(1e-2 * (static_cast<double>(times_s[i].size()) + phase + own));
        }
    }
    const auto of = responses_at(100.0, afferents, times_s);
    // The mean over 2000 n (n - 1) pairs or more has an error of 0.007, or five times this with
    // near certainty; the plain vector strength of five random spikes is 0.4.
    CHECK(of[0].locking * of[0].locking == Approx(R * R).margin(0.035));
}

TEST_CASE("locking weights the fibres by their pairs of spikes", "[neural]") {
    const std::vector<Afferent> afferents(2, {{}, AfferentClass::PC, 0});
    SpikeTimes times_s(2);
    for (int k = 0; k < 10; ++k)
        times_s[0].push_back(1e-2 * k); // one phase of 100 Hz: n R^2 - 1 = 9
    for (int k = 0; k < 5; ++k)
        times_s[1].push_back(1e-2 * (k + 0.2 * k)); // five phases: n R^2 - 1 = -1
    const auto of = responses_at(100.0, afferents, times_s);
    CHECK(of[0].locking == Approx(std::sqrt((90.0 * 1.0 + 20.0 * -0.25) / 110.0)).epsilon(1e-9));
}

TEST_CASE("rejects a sampling rate that is too low for the carrier", "[neural]") {
    CarrierInput carrier{.amplitude_m = 50e-6, .sampling_Hz = 80e3};
    CHECK_THROWS_AS(carrier_stimulus(carrier, {{}}, 1.0, 0.1), UsageError);
    CHECK_THROWS_WITH(carrier_stimulus(carrier, {{}}, 1.0, 0.1),
                      Catch::Contains("2 samples per cycle") && Catch::Contains("at least 200"));
    carrier.sampling_Hz = 200e3;
    CHECK(carrier_stimulus(carrier, {{}}, 1.0, 0.1).indentation_mm.samples == 20000);
}

TEST_CASE("applies the modulation to a signed, rectified or squared carrier", "[neural]") {
    CarrierInput carrier{.amplitude_m = 50e-6, .am_frequency_Hz = 200.0, .am_depth = 1.0};
    const auto line = [&](CarrierWave wave) {
        carrier.wave = wave;
        return carrier_stimulus(carrier, {{}}, 1.0, 0.005).indentation_mm.values;
    };
    const auto s = line(CarrierWave::signed_), r = line(CarrierWave::rectified),
               q = line(CarrierWave::squared);
    CHECK(q[0] == 0.0);
    for (std::size_t k = 0; k < 1000; k += 7) {
        CHECK(r[k] == std::max(s[k], 0.0));
        CHECK(q[k] == Approx(s[k] * s[k] / 0.05).margin(1e-15));
    }
    // m = 1 in the middle of the period; the largest sample is sin(2 pi/5).
    CHECK(s[501] == Approx(0.05 * std::sin(2.0 * M_PI / 5.0)).epsilon(1e-4));
}

TEST_CASE("squared carrier causes spikes at its onset, or throughout if it is modulated",
          "[neural]") {
    AfferentOptions options;
    options.classes = {AfferentClass::PC};
    const neural::Scene scene = make_scene(options);
    CarrierInput carrier{.amplitude_m = 50e-6, .am_frequency_Hz = 200.0};
    const auto spikes_in = [&](double from_s, double to_s) {
        const auto stimulus = carrier_stimulus(carrier, {{126.0, 10.0}}, 1.0, 0.1);
        std::size_t count = 0;
        for (const auto& train :
             response_to_pins(stimulus, scene, 0, scene.afferents.size(), options, 1))
            count +=
                static_cast<std::size_t>(std::count_if(train.begin(), train.end(), [&](double t_s) {
                    return t_s > from_s && t_s <= to_s;
                }));
        return count;
    };
    CHECK(spikes_in(0.0, 0.02) > 50); // 100 mm at 8 m/s take 12.5 ms
    CHECK(spikes_in(0.02, 0.1) == 0);
    carrier.am_depth = 1.0;
    CHECK(spikes_in(0.02, 0.06) > 500);
    CHECK(spikes_in(0.06, 0.1) > 500);
}

TEST_CASE("reports invalid stimuli with their values", "[neural]") {
    const Polygon skin = make_hand().outline_mm;
    PinStimulus valid = tapping({{126.0, 10.0}, {126.0, 11.0}});
    CHECK_THAT(words(check_stimulus(valid, 0.02, skin)),
               Catch::Contains("warning: pin_radius_mm") && Catch::Contains("0.5 mm"));
    valid.radius_mm = 0.5;
    CHECK(check_stimulus(valid, 0.02, skin).empty());
    struct Mistake {
        std::function<void(PinStimulus&)> make;
        const char* report;
        double silence_s = 0.02;
    };
    const auto sample = [](std::size_t k, double value) {
        return [=](PinStimulus& s) { s.indentation_mm.line(1)[k] = value; };
    };
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Mistake mistakes[] = {
        {[](PinStimulus& s) { s.radius_mm = -1.0; },
         "error: pin_radius_mm: must be above 0, and is -1"},
        {[](PinStimulus& s) { s.at_mm[1] = s.at_mm[0]; }, "error: pins: two pins"},
        // Between index and middle finger, and also one beyond the hand.
        {[](PinStimulus& s) {
             s.at_mm[1] = {20.0, 20.0};
         },
         "warning: pins: 1 of 2 pins"},
        {[](PinStimulus& s) {
             s.at_mm = {{300.0, 0.0}, {20.0, 20.0}};
         },
         "error: pins: all 2"},
        {sample(20, nan), "error: trace: 1 values"},
        {sample(20, nan), "pin 1, sample 20 (counted from 0; 4 ms)"},
        {sample(20, -1.0), "warning: trace: at 1 of 500 samples"},
        {sample(0, 0.05), "begins at 50 um"},
        {[&](PinStimulus& s) { sample(0, 0.05)(s), s.rate_Hz = 10000.0; }, "warning: silence_ms",
         0.0},
        {[&](PinStimulus& s) { sample(0, 0.05)(s), s.rate_Hz = 10000.0; }, "ringing at both ends",
         0.0},
        {[](PinStimulus& s) { s.rate_Hz = 500.0; },
         "a sampling rate of 500 Hz represents vibrations up to 250 Hz"}};
    for (const Mistake& mistake : mistakes) {
        PinStimulus stimulus = valid;
        mistake.make(stimulus);
        CHECK_THAT(words(check_stimulus(stimulus, mistake.silence_s, skin)),
                   Catch::Contains(mistake.report));
    }
    valid.at_mm[1] = {20.0, 20.0};
    CHECK(check_stimulus(valid, 0.02, {}).empty());
}

TEST_CASE("reports invalid stresses at receptors with their position", "[neural]") {
    std::vector<std::vector<double>> stress_Pa(2, std::vector<double>(10));
    stress_Pa[0][4] = 200.0;
    CHECK(check_stress(stress_Pa, 5000.0, 2, 0.02).empty());
    CHECK_THAT(words(check_stress(stress_Pa, 5000.0, 3, 0.02)),
               Catch::Contains(
                   "error: trace: expected 3 traces of stress, one per receptor, but found 2"));
    CHECK_THAT(words(check_stress(stress_Pa, 0.0, 2, 0.02)), Catch::Contains("rate must be above"));
    CHECK_THAT(words(check_stress(stress_Pa, 700.0, 2, 0.02)), Catch::Contains("up to 350 Hz"));
    stress_Pa[1][0] = 100.0;
    CHECK_THAT(words(check_stress(stress_Pa, 5000.0, 2, 0.02)),
               Catch::Contains("begins at 100 Pa"));
    CHECK_THAT(words(check_stress(stress_Pa, 1000.0, 2, 0.0)), Catch::Contains("jump of 100 Pa"));
    stress_Pa[1][7] = std::numeric_limits<double>::quiet_NaN();
    CHECK_THAT(words(check_stress(stress_Pa, 5000.0, 2, 0.02)),
               Catch::Contains("error: trace: 1 values") &&
                   Catch::Contains("receptor 1, sample 7"));
}

} // namespace test_response
