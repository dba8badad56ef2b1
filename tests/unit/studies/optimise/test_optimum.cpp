// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "problem/load/load.hpp"
#include "studies/optimise/search/search.hpp"
#include "studies/optimise/study.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <random>

namespace test_optimum {

using namespace shearwake;
using namespace shearwake::optimise;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

namespace {

double uniform(std::mt19937_64& random) {
    return std::ldexp(static_cast<double>(random() >> 11), -53);
}

/// Forms like those of a focus with a wake: N is a band, and D adds a decaying memory.
Forms forms_with_memory(Index knots, double memory) {
    Forms forms{.numerator = MatrixXd::Zero(knots, knots),
                .denominator = MatrixXd::Zero(knots, knots),
                .focal = {}};
    for (Index i = 0; i < knots; ++i)
        for (Index j = 0; j < knots; ++j) {
            const auto lag = static_cast<double>(std::abs(i - j));
            forms.numerator(i, j) = 1e-9 * std::exp(-2.0 * lag * lag);
            forms.denominator(i, j) =
                forms.numerator(i, j) + 4e-9 * std::exp(-lag / memory) * std::cos(0.8 * lag);
        }
    forms.focal = forms.numerator;
    return forms;
}

VectorXd random_envelope(Index knots, std::mt19937_64& random) {
    VectorXd e(knots);
    for (double& value : e)
        value = uniform(random);
    return e;
}

} // namespace

TEST_CASE("gradients of eta and of the strength agree with finite differences", "[optimise]") {
    const Forms forms = forms_with_memory(17, 4.0);
    std::mt19937_64 random(7);
    const VectorXd e = random_envelope(17, random);
    const VectorXd of_eta = eta_gradient(forms, e),
                   of_strength = squared_strength_gradient(forms, e);
    // Central differences: the error is of the order step^2 = 1e-10 plus rounding / step = 1e-11.
    const double step = 1e-5;
    for (Index j = 0; j < e.size(); ++j) {
        const VectorXd more = e + step * VectorXd::Unit(17, j),
                       less = e - step * VectorXd::Unit(17, j);
        CHECK(std::abs((eta(forms, more) - eta(forms, less)) / (2.0 * step) - of_eta(j)) <
              1e-6 * of_eta.cwiseAbs().maxCoeff());
        CHECK(std::abs((squared_strength(forms, more) - squared_strength(forms, less)) /
                           (2.0 * step) -
                       of_strength(j)) < 1e-6 * of_strength.cwiseAbs().maxCoeff());
    }
}

TEST_CASE("an optimum satisfies its constraints and lies between its starts and the ceiling",
          "[optimise][nlopt]") {
    const double strength = GENERATE(0.5, 0.8, 1.0);
    const Forms forms = forms_with_memory(24, GENERATE(3.0, 12.0));
    const std::vector<VectorXd> from = starts(24, 8, 1);
    const optimise::Envelope best = best_envelope(forms, {strength}, from);
    CHECK(best.values.minCoeff() >= 0.0);
    CHECK(best.values.maxCoeff() <= 1.0);
    CHECK(best.strength >= strength * (1.0 - 1e-14));
    CHECK(best.eta == eta(forms, best.values));
    for (const VectorXd& start : from)
        if (std::sqrt(squared_strength(forms, start)) >= strength)
            CHECK(best.eta >= eta(forms, start) * (1.0 - 1e-12));
    const Certificate bound = ceiling(forms, strength);
    CHECK(is_valid(forms, bound));
    CHECK(bound.eta > best.eta);
    // Random envelopes of sufficient strength stay below it.
    std::mt19937_64 random(3);
    for (int n = 0; n < 2000; ++n) {
        const VectorXd e = random_envelope(24, random).cwiseSqrt();
        if (std::sqrt(squared_strength(forms, e)) >= strength) CHECK(eta(forms, e) < bound.eta);
    }
}

TEST_CASE("the ceiling of commuting forms is their known optimum", "[optimise][nlopt]") {
    // F = N = 1 and D = diag(d): only the squares of the values matter. For d = 1 in the first half
    // and 4 in the second, the optimum with e <= 1 has e = 1 where d = 1 and e^2 = 2 s^2 - 1
    // elsewhere: eta = 2 s^2 / (1 + 4 (2 s^2 - 1)), and the relaxation is exact.
    const Index n = 10;
    VectorXd d = VectorXd::Ones(n);
    d.tail(n / 2).setConstant(4.0);
    const MatrixXd one = MatrixXd::Identity(n, n);
    const Forms forms{
        .numerator = one, .denominator = d.asDiagonal().toDenseMatrix(), .focal = one};
    const double s = GENERATE(0.8, 0.9, 1.0);
    const double known = 2.0 * s * s / (1.0 + 4.0 * (2.0 * s * s - 1.0));
    const Certificate bound = ceiling(forms, s);
    CHECK(bound.eta >= known);
    CHECK(bound.eta < known * (1.0 + 3e-4)); // the accuracy of the bisection, 1e-4, and a margin
    CHECK(best_envelope(forms, {s}, starts(n, 6, 1)).eta == Approx(known).epsilon(1e-6));
}

TEST_CASE("the ceiling of few knots excludes what only negative values reach",
          "[optimise][nlopt]") {
    // All envelopes of three knots in steps of 1 / 20, with and without negative values.
    const Forms forms = forms_with_memory(3, 4.0);
    const double s = GENERATE(0.5, 0.7, 0.9);
    double best = 0.0, best_with_signs = 0.0;
    for (int i = -20; i <= 20; ++i)
        for (int j = -20; j <= 20; ++j)
            for (int k = -20; k <= 20; ++k) {
                const VectorXd e = Eigen::Vector3d(i, j, k) / 20.0;
                if (squared_strength(forms, e) < s * s) continue;
                best_with_signs = std::max(best_with_signs, eta(forms, e));
                if (e.minCoeff() >= 0.0) best = std::max(best, eta(forms, e));
            }
    const Certificate bound = ceiling(forms, s);
    CHECK(is_valid(forms, bound));
    CHECK(bound.eta >= best);
    CHECK(bound.eta < best_with_signs);
    const optimise::Envelope found = best_envelope(forms, {s}, starts(3, 8, 1));
    CHECK(found.eta >= best * (1.0 - 1e-9)); // the grid is coarser than the search
    CHECK(found.eta <= bound.eta);
}

TEST_CASE("a required uniformity limits how weak a knot may be", "[optimise][nlopt]") {
    // Two knots with F = N = 1, D = diag(1, 4), and a point of the path at each: the rms there is
    // the value of the knot. The optimum is (1, b) with the least b that the strength,
    // 1 + b^2 >= 2 s^2, and the uniformity, 2 b >= u (1 + b), permit.
    const MatrixXd one = MatrixXd::Identity(2, 2);
    const Forms forms{.numerator = one,
                      .denominator = Eigen::Vector2d(1.0, 4.0).asDiagonal().toDenseMatrix(),
                      .focal = one,
                      .path = {Eigen::Vector2d(1.0, 0.0).asDiagonal().toDenseMatrix(),
                               Eigen::Vector2d(0.0, 1.0).asDiagonal().toDenseMatrix()}};
    const double s = GENERATE(0.72, 0.75, 0.9), u = GENERATE(0.0, 0.3, 0.8, 1.0);
    const double b = std::max(std::sqrt(2.0 * s * s - 1.0), u / (2.0 - u));
    const optimise::Envelope best = best_envelope(forms, {s, u}, starts(2, 6, 1));
    CHECK(Required{s, u}.is_met_by(forms, best.values));
    // The accuracy of the search, 1e-9, times the number of its steps, and the margin of rounding.
    CHECK(best.eta == Approx((1.0 + b * b) / (1.0 + 4.0 * b * b)).epsilon(1e-7));
}

TEST_CASE("no envelope of a fine grid with the required uniformity exceeds the optimum",
          "[optimise][nlopt]") {
    Forms forms = forms_with_memory(3, 4.0);
    // Points that every knot moves, the first knot most at the first point.
    for (Index k = 0; k < 5; ++k) {
        VectorXd near(3), far(3);
        for (Index j = 0; j < 3; ++j) {
            near(j) = 1e-4 * std::exp(-std::abs(static_cast<double>(k) / 2.0 - double(j)));
            far(j) = 3e-5 * std::cos(static_cast<double>(k + 2 * j));
        }
        forms.path.emplace_back(near * near.transpose() + far * far.transpose());
    }
    const Required required{GENERATE(0.5, 0.7), GENERATE(0.9, 0.95)};
    double best = 0.0, unconstrained = 0.0;
    for (int i = 0; i <= 40; ++i)
        for (int j = 0; j <= 40; ++j)
            for (int k = 0; k <= 40; ++k) {
                const VectorXd e = Eigen::Vector3d(i, j, k) / 40.0;
                if (!Required{required.strength, 0.0}.is_met_by(forms, e)) continue;
                unconstrained = std::max(unconstrained, eta(forms, e));
                if (required.is_met_by(forms, e)) best = std::max(best, eta(forms, e));
            }
    const optimise::Envelope found = best_envelope(forms, required, starts(3, 8, 1));
    CHECK(required.is_met_by(forms, found.values));
    CHECK(found.eta >= best * (1.0 - 1e-9)); // the grid is coarser than the search
    CHECK(found.eta < unconstrained);        // the constraint binds
}

TEST_CASE("a uniformity that the unmodulated load misses is reached if an envelope reaches it",
          "[optimise][nlopt]") {
    const MatrixXd one = MatrixXd::Identity(2, 2);
    const Forms forms{.numerator = one,
                      .denominator = one,
                      .focal = one,
                      .path = {Eigen::Vector2d(4.0, 0.0).asDiagonal().toDenseMatrix(),
                               Eigen::Vector2d(0.0, 1.0).asDiagonal().toDenseMatrix()}};
    CHECK(uniformity(rms_along_path(forms, VectorXd::Ones(2))) == Approx(2.0 / 3.0));
    const optimise::Envelope found = best_envelope(forms, {0.5, 0.9}, starts(2, 6, 1));
    CHECK(found.eta == Approx(1.0));
    CHECK(Required{0.5, 0.9}.is_met_by(forms, found.values));
    // At full strength only the unmodulated load is left.
    CHECK(best_envelope(forms, {1.0, 0.9}, starts(2, 6, 1)).eta == 0.0);
    // So is a search for AM that has no frequencies.
    CHECK(best_am(forms, {.count = 2, .interval_s = 1e-3}, {0.5, 0.9}, {}).envelope.eta == 0.0);
    CHECK(best_am(forms, {.count = 2, .interval_s = 1e-3}, {0.5, 0.6}, {}).envelope.eta ==
          Approx(1.0));
}

TEST_CASE("a certificate with a changed number is not valid", "[optimise]") {
    const Forms forms = forms_with_memory(12, 6.0);
    const Certificate bound = ceiling(forms, 0.7);
    REQUIRE(is_valid(forms, bound));
    const auto is_valid_with = [&](const auto& change) {
        Certificate changed = bound;
        change(changed);
        return is_valid(forms, changed);
    };
    CHECK_FALSE(is_valid_with([](Certificate& c) { c.eta *= 0.9; }));
    CHECK_FALSE(is_valid_with([](Certificate& c) { c.weights *= 1.1; }));
    CHECK_FALSE(is_valid_with([](Certificate& c) { c.tau *= 1.001; }));
    CHECK_FALSE(is_valid_with([](Certificate& c) { c.strength *= 0.9; }));
    CHECK_FALSE(is_valid_with([](Certificate& c) { c.mu = -1.0; }));
}

TEST_CASE("forms and optima are read back exactly", "[optimise][nlopt]") {
    Forms forms = forms_with_memory(5, 3.0);
    forms.path = {2.0 * forms.focal, forms.denominator};
    const Knots knots{.count = 5, .interval_s = 1e-3, .repeat = true};
    const Forms read = read_forms(forms_text("id", knots, forms), "file");
    CHECK(read.numerator == forms.numerator);
    CHECK(read.denominator == forms.denominator);
    CHECK(read.focal == forms.focal);
    CHECK(read.path == forms.path);
    Optimum optimum{.strength = 0.8, .eta_unmodulated = 0.123456789123456789};
    optimum.found = best_envelope(forms, {0.8}, starts(5, 3, 1));
    optimum.ceiling = ceiling(forms, 0.8);
    optimum.am = best_am(forms, knots, {0.8}, {200.0});
    const Optimum again = read_optimum(optimum_text("id", "other", optimum), "file");
    CHECK(again.found.values == optimum.found.values);
    CHECK(again.ceiling.weights == optimum.ceiling.weights);
    CHECK(again.ceiling.mu == optimum.ceiling.mu);
    CHECK(again.ceiling.tau == optimum.ceiling.tau);
    CHECK(again.am.envelope.values == optimum.am.envelope.values);
    CHECK(again.eta_unmodulated == optimum.eta_unmodulated);
    CHECK_THROWS_AS(read_forms("{\"numerator\": 1}", "file"), UsageError);
}

TEST_CASE("a waveform is rounded in the sound pressure and covers the period", "[optimise]") {
    const Knots knots{.count = 4, .interval_s = 1e-3, .repeat = true};
    VectorXd force(4);
    force << 0.0, 1.0, 0.25, 0.5;
    const Waveform waveform = waveform_of(knots, force, 2000.0, 4);
    CHECK(waveform.levels == std::vector<int>{0, 11, 15, 12, 8, 9, 11, 8});
    const SampledGain gain_of_it = gain_of(waveform);
    CHECK(gain_of_it.repeat);
    CHECK(gain_of_it.period_s() == Approx(4e-3).epsilon(1e-14));
    CHECK(gain_of_it.values[4] == Approx(64.0 / 225.0).epsilon(1e-14));
    const Trajectory rest{{Hold{.at_m = {0.01, -0.002}}}};
    CHECK(
        csv_text(waveform, rest)
            .starts_with("t_us,x_mm,y_mm,level,pressure_1,force_1\n0,10,-2,0,0,0\n500,10,-2,11,"));
    CHECK_THROWS_AS(waveform_of(knots, force, 2100.0, 4), UsageError); // 8.4 updates in 4 ms
    const Knots pass{.count = 4, .interval_s = 1e-3, .repeat = false};
    const Waveform single = waveform_of(pass, force, 2100.0, 4); // ends at 3 ms, 6.3 updates
    CHECK(single.interval_s == 1.0 / 2100.0);
    CHECK(single.levels.size() == 8);
    CHECK_THROWS_AS(waveform_of(knots, force, 1e6, 4), UsageError); // 4000 updates
}

} // namespace test_optimum
