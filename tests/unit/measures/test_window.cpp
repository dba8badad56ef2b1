// SPDX-License-Identifier: BSD-3-Clause
#include "measures/window.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>

namespace test_window {

using namespace shearwake;

const TimeAxis thesis_time{.frames = 280, .interval_s = 50e-6};

static double integral(const TimeAxis& time, double from_s, double to_s,
                       const std::function<double(double)>& f) {
    const std::vector<double> weights = measures::window_weights(time, from_s, to_s);
    double sum = 0.0;
    for (std::ptrdiff_t n = 0; n < time.frames; ++n)
        sum += weights[static_cast<std::size_t>(n)] * f(time.frame_s(n)) * time.interval_s;
    return sum;
}

TEST_CASE("between frames the window's weights are those of the trapezoidal rule", "[window]") {
    const std::vector<double> weights =
        measures::window_weights({.frames = 6, .interval_s = 0.5}, 1.0, 2.5);
    const std::vector<double> expected = {0.0, 0.5, 1.0, 1.0, 0.5, 0.0};
    for (std::size_t n = 0; n < 6; ++n)
        CHECK(weights[n] == Approx(expected[n]).margin(1e-15));
}

TEST_CASE("a window integrates straight lines exactly wherever its ends are", "[window]") {
    const double from = GENERATE(0.0, 0.03, 0.2, 1.01, 1.5);
    const double to = GENERATE(1.51, 1.6, 1.77, 2.0);
    // f(t) = 3 t has f(0) = 0, as the window assumes.
    CHECK(integral({.frames = 20, .interval_s = 0.1}, from, to, [](double t) { return 3 * t; }) ==
          Approx(1.5 * (to * to - from * from)).epsilon(1e-13)); // rounding
}

TEST_CASE("a window within one interval integrates the line across it", "[window]") {
    CHECK(integral({.frames = 4, .interval_s = 1.0}, 1.25, 1.5, [](double t) { return t; }) ==
          Approx(0.5 * (2.25 - 1.5625)).epsilon(1e-14));
}

TEST_CASE("a window over whole periods integrates a tone exactly", "[window]") {
    // 200 Hz: 100 frames a period. The trapezoidal rule is exact for a sampled periodic tone.
    const auto f = [](double t) { return 1.0 + std::cos(2 * std::numbers::pi * 200 * t + 0.4); };
    CHECK(integral(thesis_time, 4e-3, 14e-3, f) == Approx(10e-3).epsilon(1e-12));
}

TEST_CASE("the weights of a window add up to its length", "[window]") {
    const std::vector<double> weights = measures::window_weights(thesis_time, 4.0123e-3, 13.987e-3);
    CHECK(std::accumulate(weights.begin(), weights.end(), 0.0) ==
          Approx((13.987e-3 - 4.0123e-3) / 50e-6).epsilon(1e-12)); // 280 rounded additions
}

TEST_CASE("the period window takes as many whole periods as are settled", "[window]") {
    const MeasureOptions measure{.at_s = 14e-3, .settled_after_s = 4e-3};
    const auto window = [&](std::optional<double> f) {
        return measures::period_window(measure, thesis_time, f);
    };
    CHECK(window(100.0).fits());
    CHECK(window(100.0).periods == 1);
    CHECK(window(100.0).from_s == Approx(4e-3).epsilon(1e-12));
    CHECK(window(100.0).to_s == 14e-3);
    CHECK(window(300.0).periods == 3);
    CHECK(window(300.0).from_s == Approx(4e-3).epsilon(1e-9));
    CHECK(window(250.0).periods == 2);
    CHECK(window(250.0).from_s == Approx(6e-3).epsilon(1e-12));
    CHECK(window(std::nullopt).fits());
    CHECK(window(std::nullopt).periods == 0);
    CHECK(window(std::nullopt).from_s == 4e-3);
}

TEST_CASE("a sliding window is the mean over all windows of one period", "[window]") {
    const double f_Hz = GENERATE(100.0, 101.3, 130.0, 200.0, 333.0);
    const MeasureOptions measure{
        .at_s = 14e-3, .settled_after_s = 4e-3, .window = PeriodWeight::sliding};
    const measures::PeriodWindow window = measures::period_window(measure, thesis_time, f_Hz);
    REQUIRE(window.fits());
    CHECK(window.from_s == 4e-3);
    CHECK(window.to_s == 14e-3);
    const std::vector<double> weights =
        measures::window_weights(thesis_time, window.from_s, window.to_s, window.edge_s);
    const double period_s = 1.0 / f_Hz, last_s = 14e-3 - period_s;
    std::vector<double> mean(weights.size(), 0.0);
    const int positions = 4000; // midpoints: the error is proportional to 1 / positions^2
    for (int i = 0; i < positions; ++i) {
        const double from_s = std::lerp(4e-3, last_s, (i + 0.5) / positions);
        const std::vector<double> one =
            measures::window_weights(thesis_time, from_s, from_s + period_s);
        for (std::size_t n = 0; n < one.size(); ++n)
            mean[n] += one[n] / positions;
    }
    // The height of the trapezoid is 1; that of the mean depends on its position.
    const double scale = std::accumulate(weights.begin(), weights.end(), 0.0) /
                         std::accumulate(mean.begin(), mean.end(), 0.0);
    double worst = 0.0;
    for (std::size_t n = 0; n < mean.size(); ++n)
        worst = std::max(worst, std::abs(scale * mean[n] - weights[n]));
    CHECK(worst < 1e-5);
}

TEST_CASE("a sliding window is continuous where another period fits", "[window]") {
    const auto mean_at = [](PeriodWeight kind, double f_Hz) {
        const MeasureOptions measure{.at_s = 14e-3, .settled_after_s = 4e-3, .window = kind};
        const auto window = measures::period_window(measure, thesis_time, f_Hz);
        const std::vector<double> weights =
            measures::window_weights(thesis_time, window.from_s, window.to_s, window.edge_s);
        double sum = 0.0, all = 0.0;
        for (std::size_t n = 0; n < weights.size(); ++n) {
            const double t = thesis_time.frame_s(static_cast<std::ptrdiff_t>(n));
            const double tone = std::cos(2.0 * std::numbers::pi * f_Hz * t + 0.4);
            sum += weights[n] * (100.0 * t + tone);
            all += weights[n];
        }
        return sum / all;
    };
    const auto jump = [&](PeriodWeight kind) {
        return std::abs(mean_at(kind, 200.001) - mean_at(kind, 199.999));
    };
    CHECK(jump(PeriodWeight::whole_periods) > 0.1);
    CHECK(jump(PeriodWeight::sliding) < 1e-4);
    // The trend alone: no harmonic of the modulation remains. Frames resolve 100 of a period.
    CHECK(mean_at(PeriodWeight::sliding, 170.0) == Approx(0.9).epsilon(1e-3));
}

TEST_CASE("a period that does not fit has a reason and no window", "[window]") {
    const MeasureOptions measure{.at_s = 14e-3, .settled_after_s = 4e-3};
    const measures::PeriodWindow slow = measures::period_window(measure, thesis_time, 99.0);
    CHECK_FALSE(slow.fits());
    CHECK(slow.reason == "a period of 99 Hz takes 10.1 ms and does not fit between 4 and 14 ms");
    CHECK_FALSE(
        measures::period_window({.at_s = 4e-3, .settled_after_s = 4e-3}, thesis_time, {}).fits());
    CHECK_FALSE(
        measures::period_window({.at_s = 15e-3, .settled_after_s = 4e-3}, thesis_time, {}).fits());
    CHECK_FALSE(measures::period_window(measure, thesis_time, 8000.0).fits());
    CHECK(measures::period_window(measure, thesis_time, 5000.0).fits()); // four frames a period
}

TEST_CASE("there is no period window after the focus has been switched off", "[window]") {
    const MeasureOptions measure{.at_s = 14e-3, .settled_after_s = 4e-3};
    const TimeAxis time{280, 50e-6};
    CHECK(measures::period_window(measure, time, 200.0, 14e-3).fits());
    CHECK(measures::period_window(measure, time, {}, 13.96e-3).fits()); // within a frame
    const measures::PeriodWindow out = measures::period_window(measure, time, 200.0, 7e-3);
    CHECK_FALSE(out.fits());
    CHECK(out.reason == "the path ends at 7 ms: there is no load at the instant, 14 ms");
    CHECK_FALSE(measures::period_window(measure, time, {}, 7e-3).fits());
}

} // namespace test_window
