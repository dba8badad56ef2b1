// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/design.hpp"
#include "sampling/distribution.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <string>

namespace test_distribution {

using namespace shearwake;
using sampling::Distribution;
using sampling::Sampling;

constexpr std::size_t sample_size = 2000;

/// The Kolmogorov-Smirnov distance between sample_size values of the distribution and its analytic
/// cumulative distribution.
static double distance(const Distribution& d, Sampling sampling,
                       const std::function<double(double)>& cumulative) {
    REQUIRE_FALSE(sampling::problem_of(d).has_value());
    std::vector<double> values;
    for (const auto& point : sampling::unit_points(sampling, sample_size, 1, 42))
        values.push_back(sampling::quantile(d, point[0]));
    std::ranges::sort(values);
    double largest = 0.0;
    for (std::size_t i = 0; i < sample_size; ++i) {
        const double below = static_cast<double>(i) / sample_size, p = cumulative(values[i]);
        largest = std::max({largest, std::abs(p - below), std::abs(p - below - 1.0 / sample_size)});
    }
    return largest;
}

static double normal_below(double z) {
    return 0.5 * std::erfc(-z / std::sqrt(2.0));
}

static void check_fit(const Distribution& d, const std::function<double(double)>& cumulative) {
    // The critical value of the test at the level of 0.1 % is 1.95 / sqrt(sample_size).
    CHECK(distance(d, Sampling::random, cumulative) < 1.95 / std::sqrt(sample_size));
    // The other sequences have one value per interval of 1/1024.
    CHECK(distance(d, Sampling::sobol, cumulative) < 3.0 / 1024.0);
    CHECK(distance(d, Sampling::latin_hypercube, cumulative) < 0.03);
    for (const double p : {0.001, 0.3, 0.999})
        CHECK(cumulative(sampling::quantile(d, p)) == Approx(p).epsilon(1e-9));
}

TEST_CASE("samples follow their analytic distributions (Kolmogorov-Smirnov)", "[sampling]") {
    check_fit({.shape = sampling::Uniform{2.0, 6.0}}, [](double x) { return (x - 2.0) / 4.0; });
    check_fit({.shape = sampling::Normal{5.0, 2.0}},
              [](double x) { return normal_below((x - 5.0) / 2.0); });
    check_fit({.shape = sampling::LogNormal{5.0, 1.5}},
              [](double x) { return normal_below(std::log(x / 5.0) / std::log(1.5)); });
    check_fit({.shape = sampling::Triangular{1.0, 2.0, 5.0}}, [](double x) {
        return x < 2.0 ? (x - 1.0) * (x - 1.0) / 4.0 : 1.0 - (5.0 - x) * (5.0 - x) / 12.0;
    });
    check_fit({.shape = sampling::Empirical{{1.0, 2.0, 4.0}}},
              [](double x) { return x < 2.0 ? 0.5 * (x - 1.0) : 0.5 + 0.25 * (x - 2.0); });
}

TEST_CASE("truncated samples follow the conditional distribution", "[sampling]") {
    const double low = normal_below(-1.0), high = normal_below(2.0);
    check_fit({.shape = sampling::Normal{5.0, 2.0}, .least = 3.0, .most = 9.0},
              [&](double x) { return (normal_below((x - 5.0) / 2.0) - low) / (high - low); });
    const Distribution d{.shape = sampling::LogNormal{5.0, 1.5}, .least = 4.0, .most = 6.0};
    CHECK(sampling::quantile(d, 1e-12) >= 4.0);
    CHECK(sampling::quantile(d, 1.0 - 1e-12) <= 6.0);
}

TEST_CASE("a distribution of moduli gives shear-wave speeds", "[sampling]") {
    // E = 3 rho c_s^2 = 27 kPa at 3 m/s and 1000 kg/m3.
    const Distribution d{.shape = sampling::Normal{27.0, 3.0}, .least = 1.0, .root_of = 1.0 / 3.0};
    CHECK(sampling::quantile(d, 0.5) == Approx(3.0));
    check_fit(d, [](double c) { return normal_below((3.0 * c * c - 27.0) / 3.0); });
}

TEST_CASE("unusable distributions are rejected with the reason", "[sampling]") {
    using Row = std::pair<Distribution, std::string>;
    const auto [d, reason] =
        GENERATE(Row{{.shape = sampling::Uniform{2.0, 2.0}}, "min < max"},
                 Row{{.shape = sampling::Normal{5.0, -1.0}}, "sd above 0"},
                 Row{{.shape = sampling::Normal{5.0, std::nan("")}}, "sd above 0"},
                 Row{{.shape = sampling::LogNormal{-5.0, 1.5}}, "median above 0"},
                 Row{{.shape = sampling::Triangular{1.0, 6.0, 5.0}}, "mode"},
                 Row{{.shape = sampling::Empirical{{1.0, 1.0}}}, "different values"},
                 Row{{.shape = sampling::Normal{5.0, 1.0}, .least = 100.0}, "truncated to nothing"},
                 Row{{.shape = sampling::Normal{5.0, 1.0}, .least = 6.0, .most = 4.0},
                     "truncated to nothing"},
                 Row{{.shape = sampling::Normal{5.0, 3.0}, .root_of = 1.0}, "negative moduli"});
    CHECK_THAT(sampling::problem_of(d).value_or(""), Catch::Contains(reason));
}

} // namespace test_distribution
