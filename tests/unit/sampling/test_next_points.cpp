// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/next_points.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

namespace test_next_points {

using namespace shearwake;
using Goal = AdaptiveAxis::Goal;
using Function = std::function<double(double)>;

/// The points of all rounds, with functions instead of a sweep.
static std::vector<double> points_of(const AdaptiveAxis& axis,
                                     const std::vector<Function>& functions) {
    std::vector<double> x = adapt::first_points(axis);
    for (int round = 0; round < 100; ++round) {
        std::vector<adapt::Curve> curves;
        for (const Function& f : functions) {
            curves.emplace_back();
            for (const double at : x)
                curves.back().push_back(f(at));
        }
        const std::vector<double> more = adapt::next_points(axis, x, curves);
        if (more.empty()) return x;
        x.insert(x.end(), more.begin(), more.end());
        std::ranges::sort(x);
        CHECK(std::ranges::adjacent_find(x) == x.end());
    }
    FAIL("no end after 100 rounds");
    return x;
}

static double interpolated(const std::vector<double>& x, const Function& f, double at) {
    const auto next = std::clamp(std::ranges::upper_bound(x, at), x.begin() + 1, x.end() - 1);
    const double a = *(next - 1), b = *next;
    return std::lerp(f(a), f(b), (at - a) / (b - a));
}

/// A curve like that of eta against the modulation frequency, with a bend at 200 Hz.
static double bend(double f_Hz) {
    return 0.3 - 0.15 / (1.0 + std::exp(-(f_Hz - 200.0) / 25.0)) + 1e-5 * f_Hz;
}

TEST_CASE("a refined curve stays within its tolerance of a fine grid", "[adapt]") {
    const AdaptiveAxis axis{
        .key = "k", .first = 100.0, .last = 800.0, .tolerance = 0.002, .smallest_step = 0.1};
    const Function rise = [](double f) { return 0.1 + 0.2 * std::log(f / 100.0); };
    const std::vector<double> x = points_of(axis, {bend, rise});
    const std::size_t fine = 5 * x.size();
    for (const Function& f : {Function(bend), rise})
        for (std::size_t i = 0; i <= fine; ++i) {
            const double at =
                std::lerp(100.0, 800.0, static_cast<double>(i) / static_cast<double>(fine));
            CHECK(std::abs(interpolated(x, f, at) - f(at)) < 0.002);
        }
    // Uniform spacing with the same estimate needs max |f''| h^2 / 2 = tolerance, with |f''| = 0.15
    // / 25^2 / 10.4 at the bend.
    const double uniform = 700.0 / std::sqrt(2.0 * 0.002 / (0.15 / 625.0 / 10.4));
    CHECK(static_cast<double>(x.size()) < uniform);
}

TEST_CASE("a curve with an abrupt change of its slope stays within the tolerance", "[adapt]") {
    const AdaptiveAxis axis{
        .key = "k", .first = 0.0, .last = 1.0, .tolerance = 0.002, .smallest_step = 1e-3};
    for (double corner = 0.2; corner < 0.8; corner += 0.017) {
        const Function f = [corner](double t) { return 0.2 * std::abs(t - corner) + 0.1 * t; };
        const std::vector<double> x = points_of(axis, {f});
        double worst = 0.0;
        for (double at = 0.0; at <= 1.0; at += 0.001)
            worst = std::max(worst, std::abs(interpolated(x, f, at) - f(at)));
        INFO("corner at " << corner);
        CHECK(worst < 0.002);
        CHECK(x.size() < 40);
    }
}

TEST_CASE("extrema are found to the tolerance with few points", "[adapt]") {
    AdaptiveAxis axis{
        .key = "k", .goal = Goal::maximum, .first = 100.0, .last = 800.0, .tolerance = 1.0};
    const Function hill = [](double f) { return std::exp(-std::pow((f - 333.3) / 150.0, 2)); };
    const std::vector<double> x = points_of(axis, {hill});
    CHECK(x.size() < 70); // a tenth of a grid with a spacing of 1
    adapt::Curve curve;
    for (const double at : x)
        curve.push_back(hill(at));
    REQUIRE(adapt::locations(axis, x, curve).size() == 1);
    const adapt::Location found = adapt::locations(axis, x, curve).front();
    CHECK(std::abs(found.at - 333.3) <= 1.0);
    CHECK(found.from >= found.at - 1.0);
    CHECK(found.to <= found.at + 1.0);
    CHECK(found.value == hill(found.at));
    axis.goal = Goal::minimum;
    const std::vector<double> low = points_of(axis, {[&](double f) { return -hill(f); }});
    CHECK(low == x);
    axis.goal = Goal::maximum;
    const std::vector<double> edge = points_of(axis, {[](double f) { return f; }});
    CHECK(edge.back() == 800.0); // a maximum at the end of the interval
    CHECK(edge[edge.size() - 2] >= 799.0);
}

TEST_CASE("all crossings are found to the tolerance", "[adapt]") {
    const AdaptiveAxis axis{
        .key = "k", .goal = Goal::crossing, .first = 0.0, .last = 10.0, .tolerance = 0.01};
    const Function wave = [](double t) { return std::cos(t); };
    const std::vector<double> x = points_of(axis, {wave});
    adapt::Curve curve;
    for (const double at : x)
        curve.push_back(wave(at));
    const std::vector<adapt::Location> found = adapt::locations(axis, x, curve);
    REQUIRE(found.size() == 3);
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(std::abs(found[i].at - (static_cast<double>(i) + 0.5) * std::acos(-1.0)) < 0.01);
}

TEST_CASE("missing values and limits end the refinement", "[adapt]") {
    AdaptiveAxis axis{.key = "k", .first = 0.0, .last = 1.0, .tolerance = 1e-9};
    axis.most = 40;
    CHECK(points_of(axis, {[](double t) { return t * t * t; }}).size() == 40);
    axis.most = 10000;
    CHECK(points_of(axis, {[](double) { return std::nan(""); }}).size() == axis.initial);
    axis.goal = Goal::maximum;
    CHECK(points_of(axis, {[](double) { return std::nan(""); }}).size() == axis.initial);
}

TEST_CASE("a jump is refined down to the smallest step only", "[adapt]") {
    AdaptiveAxis axis{.key = "k", .first = 0.0, .last = 1.0, .tolerance = 0.01};
    axis.smallest_step = 1e-3;
    const std::vector<double> x = points_of(axis, {[](double t) { return t < 0.4 ? 0.0 : 1.0; }});
    double narrowest = 1.0;
    for (std::size_t i = 0; i + 1 < x.size(); ++i)
        narrowest = std::min(narrowest, x[i + 1] - x[i]);
    CHECK(narrowest >= 1e-3 * (1.0 - 1e-6)); // points are rounded to nine digits
    CHECK(narrowest < 2e-3);
    CHECK(x.size() < 60); // four intervals at the jump are halved in each of the seven rounds
}

TEST_CASE("the intervals with the largest errors come first if not all fit", "[adapt]") {
    AdaptiveAxis axis{.key = "k", .first = 0.0, .last = 8.0, .tolerance = 1e-9};
    axis.most = 10;
    const std::vector<double> x = adapt::first_points(axis);
    adapt::Curve curve;
    for (const double at : x)
        curve.push_back(std::exp(at));
    const std::vector<double> next = adapt::next_points(axis, x, {curve});
    REQUIRE(next.size() == 1);
    // The largest known curvature, at 7, is near the last three intervals; the first of them
    // counts.
    CHECK(next.front() == 5.5);
}

TEST_CASE("the estimated error bounds that of a parabola and ignores missing points", "[adapt]") {
    const std::vector<double> x = {0.0, 1.0, 2.0, 4.0, 5.0};
    adapt::Curve curve;
    for (const double at : x)
        curve.push_back(3.0 * at * at);
    const std::vector<double> errors = adapt::interpolation_errors(x, curve);
    REQUIRE(errors.size() == 4);
    CHECK(errors[0] == Approx(3.0)); // h^2 / 2 * 6
    CHECK(errors[2] == Approx(12.0));
    curve[1] = std::nan("");
    CHECK(adapt::interpolation_errors(x, curve)[2] == Approx(12.0));
    curve[3] = std::nan("");
    curve[4] = std::nan("");
    CHECK(std::isnan(adapt::interpolation_errors(x, curve)[0]));
}

} // namespace test_next_points
