// SPDX-License-Identifier: BSD-3-Clause
#include "measures/surface_sums.hpp"

#include "measures/spatial_measures.hpp"

#include <catch2/catch.hpp>

#include <cmath>
#include <numbers>
#include <random>
#include <vector>

namespace test_surface_sums {

using namespace shearwake;

const Domain thesis_domain{.nx = 256, .ny = 192, .spacing_m = 0.75e-3, .sponge_m = 12e-3};

/// Like a wake of nearly incompressible tissue: a spot and wavelets over the whole plane, shifted
/// so that next to nothing is left of the sum.
static std::vector<double> realistic_frame(const Domain& d) {
    std::vector<double> u;
    std::mt19937 random(7);
    std::normal_distribution<double> noise(0.0, 1e-9);
    for (std::ptrdiff_t i = 0; i < d.nx; ++i)
        for (std::ptrdiff_t j = 0; j < d.ny; ++j) {
            const double r = std::hypot(d.x_m(i) - 20e-3, d.y_m(j));
            u.push_back(3e-6 * std::exp(-r * r / 8e-6) +
                        4e-7 * std::cos(r / 2e-3) / (1 + r / 5e-3) + noise(random));
        }
    const measures::Region region = measures::measured_region(d);
    double sum = 0.0;
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
        for (std::ptrdiff_t j = region.y0; j < region.y1; ++j)
            sum += u[static_cast<std::size_t>(i * d.ny + j)];
    const double mean =
        sum / static_cast<double>((region.x1 - region.x0) * (region.y1 - region.y0));
    for (double& value : u)
        value -= 0.999 * mean; // leaves 1/1000 of what a positive field has
    return u;
}

static measures::SurfaceSums sums_of_slabs(const std::vector<double>& u, const Domain& d,
                                           const std::vector<std::ptrdiff_t>& cuts, Vec2 focus) {
    measures::SurfaceSums sums;
    for (std::size_t s = 0; s + 1 < cuts.size(); ++s) {
        const View2<const double> slab(u.data() + cuts[s] * d.ny, cuts[s + 1] - cuts[s], d.ny);
        sums = measures::combine(
            sums,
            measures::surface_sums(slab, cuts[s], d, measures::measured_region(d), focus, 3e-3));
    }
    return sums;
}

/// Positive sums differ by rounding; the signed one, of which little is left, by `margin`.
static void check_equal(const measures::SurfaceSums& a, const measures::SurfaceSums& b,
                        double margin) {
    CHECK(a.u == Approx(b.u).margin(margin));
    CHECK(a.abs_u == Approx(b.abs_u).epsilon(1e-14));
    CHECK(a.u2 == Approx(b.u2).epsilon(1e-14));
    CHECK(a.u4 == Approx(b.u4).epsilon(1e-14));
    CHECK(a.focal_u2 == Approx(b.focal_u2).epsilon(1e-14));
    CHECK(a.focal_weight == Approx(b.focal_weight).epsilon(1e-14));
    CHECK(a.peak == b.peak);
}

TEST_CASE("the measured region is the plane inside the sponge", "[surface_sums]") {
    CHECK(measures::measured_region(thesis_domain) == measures::Region{16, 240, 16, 176});
    CHECK(measures::measured_region({.nx = 10, .ny = 8, .spacing_m = 1e-3, .sponge_m = 0.0}) ==
          measures::Region{0, 10, 0, 8});
    // A sponge of two cells and a bit covers three; one wider than the domain leaves nothing.
    CHECK(measures::measured_region({.nx = 10, .ny = 8, .spacing_m = 1e-3, .sponge_m = 2.1e-3}) ==
          measures::Region{3, 7, 3, 5});
    CHECK(measures::measured_region({.nx = 10, .ny = 8, .spacing_m = 1e-3, .sponge_m = 9e-3}) ==
          measures::Region{5, 5, 4, 4});
}

static measures::Region region_of(const Domain& d, std::vector<Vec2> corners) {
    MeasureOptions measure;
    measure.region_m = std::move(corners);
    return measures::measured_region(d, measure);
}

static std::vector<Vec2> rectangle(double half_x_m, double half_y_m) {
    return {
        {-half_x_m, -half_y_m}, {half_x_m, -half_y_m}, {half_x_m, half_y_m}, {-half_x_m, half_y_m}};
}

/// The weight of every sample, row by row.
static std::vector<double> weights_of(const Domain& d, const measures::Region& region) {
    std::vector<double> weights(static_cast<std::size_t>(d.nx * d.ny), 0.0);
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
        region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
            for (std::ptrdiff_t j = first; j < end; ++j)
                weights[static_cast<std::size_t>(i * d.ny + j)] = weight;
        });
    return weights;
}

static bool is_in_polygon(const std::vector<Vec2>& corners, Vec2 at) {
    bool inside = false;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2 a = corners[n], b = corners[(n + 1) % corners.size()];
        if ((a.x > at.x) != (b.x > at.x) && at.y < a.y + (at.x - a.x) / (b.x - a.x) * (b.y - a.y))
            inside = !inside;
    }
    return inside;
}

TEST_CASE("a region whose edges lie on samples is symmetric and has its stated area",
          "[surface_sums]") {
    // An edge that differs from the samples by rounding is the same edge.
    const double off_m = GENERATE(0.0, 1e-16, -1e-16, 1e-11, -1e-11);
    const Domain d{.nx = 40, .ny = 30, .spacing_m = 1e-3, .sponge_m = 2e-3};
    const measures::Region region = region_of(d, rectangle(4e-3 + off_m, 3e-3 - off_m));
    CHECK(region.x0 == 16);
    CHECK(region.x1 == 25);
    CHECK(region.y0 == 12);
    CHECK(region.y1 == 19);
    CHECK(region.samples() == 9 * 7);
    CHECK(region.cells() == Approx(8.0 * 6.0).epsilon(1e-6)); // 1e-11 m of 6 mm, at both edges
    const auto weights = weights_of(d, region);
    for (std::ptrdiff_t i = 1; i < d.nx; ++i)
        for (std::ptrdiff_t j = 1; j < d.ny; ++j) {
            const auto at = [&](std::ptrdiff_t x, std::ptrdiff_t y) {
                return weights[static_cast<std::size_t>(x * d.ny + y)];
            };
            // Corners count as a quarter, edges as a half; the tolerance is that of the offset.
            const double x = std::abs(d.x_m(i)) * 1e3, y = std::abs(d.y_m(j)) * 1e3;
            const auto part = [](double from_edge) {
                return from_edge < -0.1 ? 0.0 : from_edge > 0.1 ? 1.0 : 0.5;
            };
            CHECK(at(i, j) == Approx(part(4.0 - x) * part(3.0 - y)).margin(1e-7));
            CHECK(at(i, j) == Approx(at(d.nx - i, d.ny - j)).margin(1e-7)); // mirrored
        }
}

TEST_CASE("the area of a stated region does not depend on the spacing", "[surface_sums]") {
    const double half_x_m = 9.3e-3, half_y_m = 7.77e-3;
    for (const std::ptrdiff_t n : {20, 40, 54, 80}) {
        const Domain d{.nx = 2 * n, .ny = 2 * n, .spacing_m = 40e-3 / static_cast<double>(2 * n)};
        const double cell_m2 = d.spacing_m * d.spacing_m;
        CHECK(region_of(d, rectangle(half_x_m, half_y_m)).cells() * cell_m2 ==
              Approx(4.0 * half_x_m * half_y_m).epsilon(1e-6));
    }
}

TEST_CASE("a stated region ends at the sponge or half a cell inside the domain", "[surface_sums]") {
    Domain d{.nx = 40, .ny = 30, .spacing_m = 1e-3, .sponge_m = 2e-3};
    CHECK(region_of(d, {}) == measures::measured_region(d));
    CHECK(region_of(d, rectangle(1.0, 1.0)).cells() == Approx(36.0 * 26.0).epsilon(1e-12));
    CHECK(region_of(d, {{0.5, 0.5}, {0.6, 0.5}, {0.6, 0.6}}).samples() == 0);
    d.sponge_m = 0.0;
    CHECK(region_of(d, rectangle(1.0, 1.0)) == measures::Region{1, 40, 1, 30}); // symmetric
    // The outline of the whole plane consists of the outer edges of all cells.
    const auto outline = measures::measured_outline(d, {});
    CHECK(outline.front().x == Approx(-20.5e-3).epsilon(1e-14));
    CHECK(outline[2].y == Approx(14.5e-3).epsilon(1e-14));
    Domain larger = d;
    larger.nx *= 2;
    larger.ny *= 2;
    CHECK(region_of(larger, outline) == measures::Region{20, 60, 15, 45});
}

TEST_CASE("samples count with the fraction of their cell inside a concave polygon",
          "[surface_sums]") {
    const Domain d{.nx = 40, .ny = 30, .spacing_m = 1e-3, .sponge_m = 2e-3};
    const std::vector<Vec2> corners = {{-9.3e-3, -8.2e-3},
                                       {11.1e-3, -7.7e-3},
                                       {2.4e-3, 0.3e-3},
                                       {10.6e-3, 9.9e-3},
                                       {-8.8e-3, 7.1e-3}};
    const measures::Region region = region_of(d, corners);
    const auto weights = weights_of(d, region);
    double twice_area_m2 = 0.0;
    for (std::size_t n = 0; n < corners.size(); ++n) {
        const Vec2 a = corners[n], b = corners[(n + 1) % corners.size()];
        twice_area_m2 += a.x * b.y - b.x * a.y;
    }
    // Weights below a millionth are left out.
    CHECK(region.cells() * 1e-6 == Approx(0.5 * twice_area_m2).epsilon(1e-6));
    const auto u = realistic_frame(d);
    const View2<const double> all(u.data(), d.nx, d.ny);
    const Vec2 focus{3e-3, 1e-3};
    double u2 = 0.0, focal_u2 = 0.0, farthest = 0.0;
    for (std::ptrdiff_t i = 0; i < d.nx; ++i)
        for (std::ptrdiff_t j = 0; j < d.ny; ++j) {
            constexpr int points = 40;
            int inside = 0;
            for (int a = 0; a < points; ++a)
                for (int b = 0; b < points; ++b)
                    inside +=
                        is_in_polygon(corners, {d.x_m(i) + 1e-3 * ((a + 0.5) / points - 0.5),
                                                d.y_m(j) + 1e-3 * ((b + 0.5) / points - 0.5)});
            const double w = weights[static_cast<std::size_t>(i * d.ny + j)];
            farthest = std::max(farthest, std::abs(w - inside / double(points * points)));
            u2 += w * all(i, j) * all(i, j);
            focal_u2 += w * all(i, j) * all(i, j) *
                        measures::disc_fraction(d.x_m(i), d.y_m(j), d.spacing_m, focus, 4e-3);
        }
    // Per column of points, one edge is known to half a point, and two edges at a corner.
    CHECK(farthest < 1.0 / 40);
    const measures::SurfaceSums sums = measures::surface_sums(all, 0, d, region, focus, 4e-3);
    CHECK_THAT(sums.u2,
               Catch::Matchers::WithinRel(u2, 1e-13)); // sums of some hundred positive terms
    CHECK_THAT(sums.focal_u2, Catch::Matchers::WithinRel(focal_u2, 1e-13));
}

TEST_CASE("surface sums agree with sums taken one sample at a time", "[surface_sums]") {
    // 37 columns inside the sponge: not a multiple of the lanes.
    const Domain d{.nx = 30, .ny = 41, .spacing_m = 1e-3, .sponge_m = 2e-3};
    const std::vector<double> u = realistic_frame(d);
    const measures::Region region = measures::measured_region(d);
    const Vec2 focus{1.3e-3, -2.2e-3};
    long double sum = 0, abs = 0, u2 = 0, u4 = 0, focal = 0, weight = 0;
    double peak = 0;
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
        for (std::ptrdiff_t j = region.y0; j < region.y1; ++j) {
            const double v = u[static_cast<std::size_t>(i * d.ny + j)];
            const double w = measures::disc_fraction(d.x_m(i), d.y_m(j), d.spacing_m, focus, 3e-3);
            sum += v;
            abs += std::abs(v);
            u2 += v * v;
            u4 += v * v * v * v;
            focal += w * v * v;
            weight += w;
            peak = std::max(peak, std::abs(v));
        }
    const measures::SurfaceSums sums =
        measures::surface_sums({u.data(), d.nx, d.ny}, 0, d, region, focus, 3e-3);
    const auto in_double = [](long double value) { return static_cast<double>(value); };
    // A thousand additions in double, most of them compensated.
    check_equal(sums,
                {in_double(sum), in_double(abs), in_double(u2), in_double(u4), in_double(focal),
                 in_double(weight), peak},
                1e-14 * in_double(abs));
    CHECK(sums.focal_weight == Approx(std::numbers::pi * 9.0).epsilon(1e-12)); // r = 3 cells
}

TEST_CASE("surface sums do not depend on how the rows are cut", "[surface_sums]") {
    const std::vector<double> u = realistic_frame(thesis_domain);
    const Vec2 focus{20e-3, 0.0};
    const measures::SurfaceSums whole = sums_of_slabs(u, thesis_domain, {0, 256}, focus);
    REQUIRE(std::abs(whole.u) < 2e-3 * whole.abs_u);
    using Cuts = std::vector<std::ptrdiff_t>;
    // Through the focus (row 155), inside the sponge only (0 to 9), and an empty slab.
    const Cuts cuts = GENERATE(Cuts{0, 155, 256}, Cuts{0, 9, 154, 256}, Cuts{0, 128, 128, 256},
                               Cuts{0, 50, 103, 153, 205, 256});
    const measures::SurfaceSums cut = sums_of_slabs(u, thesis_domain, cuts, focus);
    // The signed sum: 1e-16 of the partial sums, which are up to a thousand times what is left.
    check_equal(cut, whole, 1e-12 * std::abs(whole.u));
}

TEST_CASE("a focal disc outside the measured region has no weight", "[surface_sums]") {
    const std::vector<double> u = realistic_frame(thesis_domain);
    const measures::SurfaceSums sums = sums_of_slabs(u, thesis_domain, {0, 256}, {-95e-3, 71e-3});
    CHECK(sums.focal_weight == 0.0);
    CHECK(sums.focal_u2 == 0.0);
    CHECK(sums.u2 > 0.0);
}

TEST_CASE("a NaN in the frame shows in the sums", "[surface_sums]") {
    std::vector<double> u = realistic_frame(thesis_domain);
    u[static_cast<std::size_t>(100 * thesis_domain.ny + 100)] = std::nan("");
    CHECK(std::isnan(sums_of_slabs(u, thesis_domain, {0, 100, 256}, {}).u2));
}

TEST_CASE("several foci have one focal disc each", "[surface_sums]") {
    const Domain& d = thesis_domain;
    const std::vector<double> u = realistic_frame(d);
    const View2<const double> all(u.data(), d.nx, d.ny);
    const measures::Region region = measures::measured_region(d);
    const std::vector<Vec2> apart = {{20e-3, 0.0}, {-11e-3, 7e-3}};
    const measures::SurfaceSums both = measures::surface_sums(all, 0, d, region, apart, 3e-3);
    const measures::SurfaceSums first = measures::surface_sums(all, 0, d, region, apart[0], 3e-3),
                                second = measures::surface_sums(all, 0, d, region, apart[1], 3e-3);
    CHECK(both.focal_u2 == Approx(first.focal_u2 + second.focal_u2).epsilon(1e-13));
    CHECK(both.focal_weight == Approx(first.focal_weight + second.focal_weight).epsilon(1e-13));
    CHECK(both.u2 == first.u2);
    const std::vector<Vec2> twice = {apart[0], apart[0]};
    const measures::SurfaceSums same = measures::surface_sums(all, 0, d, region, twice, 3e-3);
    // Cells at the rim count up to twice their part, those inside once.
    CHECK(same.focal_weight >= first.focal_weight);
    CHECK(same.focal_weight < 1.3 * first.focal_weight);
}

} // namespace test_surface_sums
