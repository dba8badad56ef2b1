// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/design.hpp"
#include "sampling/distribution.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numeric>
#include <set>

namespace test_points {

using namespace shearwake;
using sampling::Points;
using sampling::Sampling;

static std::vector<double> column(const Points& points, std::size_t d) {
    std::vector<double> x;
    for (const auto& point : points)
        x.push_back(point[d]);
    return x;
}

/// Spearman's coefficient of two columns without ties.
static double rank_correlation(const Points& points, std::size_t a, std::size_t b) {
    const auto ranks = [&](std::size_t d) {
        const std::vector<double> x = column(points, d);
        std::vector<std::size_t> order(x.size());
        std::iota(order.begin(), order.end(), std::size_t{0});
        std::ranges::sort(order, {}, [&](std::size_t i) { return x[i]; });
        std::vector<double> rank(x.size());
        for (std::size_t i = 0; i < order.size(); ++i)
            rank[order[i]] = static_cast<double>(i);
        return rank;
    };
    const std::vector<double> u = ranks(a), v = ranks(b);
    double squares = 0.0;
    for (std::size_t i = 0; i < u.size(); ++i)
        squares += (u[i] - v[i]) * (u[i] - v[i]);
    const auto n = static_cast<double>(u.size());
    return 1.0 - 6.0 * squares / (n * (n * n - 1.0));
}

TEST_CASE("an extended sample begins with the smaller one", "[sampling]") {
    for (const Sampling kind : {Sampling::sobol, Sampling::latin_hypercube, Sampling::random}) {
        const Points large = sampling::unit_points(kind, 300, 4, 7);
        for (const std::size_t n : {1U, 2U, 17U, 128U}) {
            const Points small = sampling::unit_points(kind, n, 4, 7);
            CHECK(std::ranges::equal(
                small, Points(large.begin(), large.begin() + static_cast<std::ptrdiff_t>(n))));
        }
        CHECK(sampling::unit_points(kind, 300, 4, 8) != large);
        for (const auto& point : large)
            for (const double x : point)
                CHECK((x > 0.0 && x < 1.0));
        CHECK(std::set<std::vector<double>>(large.begin(), large.end()).size() == 300);
    }
}

TEST_CASE("Sobol points and Latin hypercubes have one point in each interval", "[sampling]") {
    for (const Sampling kind : {Sampling::sobol, Sampling::latin_hypercube})
        for (const std::size_t n : {2U, 64U, 1024U}) {
            const Points points = sampling::unit_points(kind, n, 12, 3);
            for (std::size_t d = 0; d < 12; ++d) {
                std::set<std::size_t> intervals;
                for (const double x : column(points, d))
                    intervals.insert(static_cast<std::size_t>(x * static_cast<double>(n)));
                CHECK(intervals.size() == n);
            }
        }
}

TEST_CASE("two dimensions of Sobol points fill a grid of elementary intervals", "[sampling]") {
    // The first two dimensions are a (0, 2)-sequence: 2^8 points have one point in each of 16 x 16
    // squares.
    const Points points = sampling::unit_points(Sampling::sobol, 256, 2, 5);
    std::set<std::pair<int, int>> squares;
    for (const auto& point : points)
        squares.insert({static_cast<int>(16.0 * point[0]), static_cast<int>(16.0 * point[1])});
    CHECK(squares.size() == 256);
}

TEST_CASE("Sobol points integrate a smooth function faster than random ones", "[sampling]") {
    const auto error_of = [](Sampling kind) {
        double sum = 0.0;
        const Points points = sampling::unit_points(kind, 4096, 5, 11);
        for (const auto& point : points) {
            double product = 1.0;
            for (const double x : point)
                product *= 1.0 + 0.5 * (x - 0.5);
            sum += product;
        }
        return std::abs(sum / 4096.0 - 1.0); // the integral is 1
    };
    // The standard error of 4096 random points is 0.005; Sobol points must be ten times better.
    CHECK(error_of(Sampling::sobol) < 5e-4);
    CHECK(error_of(Sampling::random) < 0.02); // four standard errors
}

TEST_CASE("a Gaussian copula gives the requested rank correlations", "[sampling]") {
    sampling::Copula copula(3);
    copula.correlate(0, 1, 0.7);
    copula.correlate(1, 2, -0.4);
    REQUIRE(copula.exists());
    Points points = sampling::unit_points(Sampling::random, 4000, 3, 2);
    const Points before = points;
    copula.apply(points);
    // The standard error of a rank correlation is about 1 / sqrt(4000) = 0.016; four of them.
    CHECK(rank_correlation(points, 0, 1) == Approx(0.7).margin(0.064));
    CHECK(rank_correlation(points, 1, 2) == Approx(-0.4).margin(0.064));
    CHECK(rank_correlation(points, 0, 2) == Approx(0.0).margin(0.064));
    // The marginal distributions remain uniform: Kolmogorov-Smirnov at the level of 0.1 %.
    for (std::size_t d = 0; d < 3; ++d) {
        std::vector<double> x = column(points, d);
        std::ranges::sort(x);
        double distance = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i)
            distance = std::max(distance, std::abs(x[i] - (static_cast<double>(i) + 0.5) / 4000.0));
        CHECK(distance < 1.95 / std::sqrt(4000.0));
    }
    Points first = {before.front()};
    copula.apply(first);
    CHECK(first.front() == points.front());
}

TEST_CASE("contradictory correlations do not exist", "[sampling]") {
    sampling::Copula copula(3);
    copula.correlate(0, 1, 0.9);
    copula.correlate(1, 2, 0.9);
    copula.correlate(0, 2, -0.9);
    CHECK_FALSE(copula.exists());
}

TEST_CASE("designs of indices change one key per row", "[sampling]") {
    for (const auto analysis : {sampling::Analysis::sobol_indices, sampling::Analysis::morris}) {
        sampling::Design design{.analysis = analysis, .samples = 8, .keys = 3, .seed = 4};
        const Points rows = sampling::design_points(design);
        const std::size_t step = sampling::rows_per_sample(design), changed = step - 3;
        REQUIRE(rows.size() == 8 * step);
        for (std::size_t j = 0; j < 8; ++j)
            for (std::size_t k = 0; k < 3; ++k)
                for (std::size_t d = 0; d < 3; ++d) {
                    const double x = rows[j * step + changed + k][d], a = rows[j * step][d];
                    CHECK((x == a) == (d != k));
                    if (changed == 2 && d == k) CHECK(x == rows[j * step + 1][d]);
                }
        design.samples = 5;
        const Points fewer = sampling::design_points(design);
        CHECK(std::ranges::equal(
            fewer, Points(rows.begin(), rows.begin() + static_cast<std::ptrdiff_t>(5 * step))));
    }
}

} // namespace test_points
