// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"
#include "measures/window.hpp"
#include "pipeline/case_content.hpp"
#include "problem/case/edges.hpp"
#include "storage/case_file/groups.hpp"

#include "support/cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <fmt/format.h>

namespace test_case_warnings {

using namespace shearwake;

/// A focus over a domain so small that `check` expects waves to return.
static Case small_domain() {
    Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    c.domain = {.nx = 20, .ny = 10, .spacing_m = 1e-3, .sponge_m = 0.0};
    c.scene.load.footprint = GaussianFootprint{4e-3};
    c.scene.load.modulation = {"AM", {{Hold{{0.0, 0.0}}}}, {{SineGain{200.0}}}};
    c.time = {.frames = 200, .interval_s = 1e-4};
    c.measure = {.at_s = 0.02, .settled_after_s = 0.005, .focal_radius_m = 4e-3};
    return c;
}

/// A mean of u_z^2 of 1 in the middle and `edge` in the first column and row.
static std::vector<double> with_edges(const Domain& d, double edge) {
    std::vector<double> mean_u2(static_cast<std::size_t>(d.nx * d.ny), 1.0);
    for (std::ptrdiff_t i = 0; i < d.nx; ++i)
        for (std::ptrdiff_t j = 0; j < d.ny; ++j)
            if (i == 0 || j == 0) mean_u2[static_cast<std::size_t>(i * d.ny + j)] = edge;
    return mean_u2;
}

static std::vector<Remark> of_extent(const std::vector<double>& mean_u2) {
    auto warnings =
        pipeline::case_warnings(small_domain(), {.mean_u2 = mean_u2}, check(small_domain()));
    std::erase_if(warnings, [](const Remark& w) { return w.key != "domain.extent_mm"; });
    return warnings;
}

TEST_CASE("the share of the energy on the edges relates their mean to that of the domain",
          "[warnings]") {
    const Domain d = small_domain().domain;
    CHECK(pipeline::edge_share(d, with_edges(d, 1.0)) == Approx(1.0).epsilon(1e-14));
    CHECK(pipeline::edge_share(d, with_edges(d, 0.0)) == 0.0);
    // 29 of 200 points have 0.1, the others 1.
    CHECK(pipeline::edge_share(d, with_edges(d, 0.1)) ==
          Approx(0.1 / ((171 + 29 * 0.1) / 200)).epsilon(1e-14));
    CHECK(pipeline::edge_share(d, std::vector<double>(200, 0.0)) == 0.0);
}

TEST_CASE("returning waves make the readings invalid only where they carry energy", "[warnings]") {
    const Domain d = small_domain().domain;
    const auto unknown = of_extent({});
    REQUIRE(!unknown.empty());
    CHECK(unknown[0].severity == Severity::warning);

    const auto strong = of_extent(with_edges(d, 0.2));
    REQUIRE(strong.size() == unknown.size());
    CHECK(strong[0].severity == Severity::error);
    CHECK_THAT(strong[0].message, Catch::Contains("the readings of this case are not valid"));

    const auto weak = of_extent(with_edges(d, 0.01));
    REQUIRE(weak.size() == unknown.size());
    CHECK(weak[0].severity == Severity::warning);
    CHECK_THAT(weak[0].message, Catch::Contains("errors of eta are at most of this order"));

    CHECK(of_extent(with_edges(d, 1e-4)).empty());
}

TEST_CASE("the uplift by images is reported where it changes the field or eta", "[warnings]") {
    Case c = small_domain();
    c.scene.load.modulation.envelope = {};
    c.scene.medium.layers[0].c_p_m_s = 100.0;
    const std::vector<double> uplift_m = image_uplift_m(c);
    const auto weights =
        measures::window_weights(c.time, c.measure.settled_after_s, c.measure.at_s);
    double square = 0.0, weight = 0.0;
    for (std::size_t n = 0; n < uplift_m.size(); ++n) {
        square += weights[n] * uplift_m[n] * uplift_m[n];
        weight += weights[n];
    }
    const double rms_m = std::sqrt(square / weight);
    // Each frame has the rms `rms` per sample, and in a focal disc of a tenth of the area `focal`;
    // both in rms values of the uplift, as is the mean.
    const auto stated = [&](double rms, double focal, double mean = 0.0) {
        const double cells = measures::measured_region(c.domain, c.measure).cells();
        std::vector<measures::SurfaceSums> surface;
        for (const double lift_m : uplift_m)
            surface.push_back({.u = cells * mean * lift_m,
                               .u2 = cells * rms * rms * rms_m * rms_m,
                               .focal_u2 = 0.1 * cells * focal * focal * lift_m * lift_m,
                               .focal_weight = 0.1 * cells});
        // Nothing has returned where the mean of u_z^2 is known to be 0 on the edges. It is not
        // kept without a period of modulation.
        const auto text = [&](const std::vector<double>& means) -> std::string {
            for (const Remark& w :
                 pipeline::case_warnings(c, {.mean_u2 = means, .surface = surface}, check(c)))
                if (w.message.find("lift the whole domain") != std::string::npos) return w.message;
            return "";
        };
        CHECK(text({}) == text(with_edges(c.domain, 0.0)));
        return text({});
    };
    // 1/sqrt(9^2 + 1) = 11 %, (200/201)^2 (82/81) - 1 = .23 %
    CHECK_THAT(stated(9.0, 200.0), Catch::Contains("estimated 11 %"));
    CHECK_THAT(stated(9.0, 200.0), Catch::Contains("eta by 0.23 %"));
    CHECK_THAT(stated(9.0, 200.0), Catch::Contains(fmt::format("by about {:.2g} um at the end of",
                                                               1e6 * uplift_m.back())));
    // `check` states the largest uplift before the run.
    const double most_m = *std::ranges::max_element(uplift_m);
    CHECK_THAT(image_uplift_text(c),
               Catch::Contains(fmt::format("by up to {:.2g} um in case ", 1e6 * most_m)));
    CHECK(stated(10.0, 200.0).empty()); // 1/sqrt(101), and eta by (200/201)^2 (101/100) - 1 < .1 %
    CHECK_THAT(stated(20.0, 50.0), Catch::Contains("eta by 3.6 %")); // (50/51)^2 (401/400) - 1
    CHECK_THAT(stated(14.0, 70.0), Catch::Contains("eta by 2.3 %")); // (70/71)^2 (197/196) - 1
    CHECK(stated(14.0, 100.0).empty());                              // 1.5 %, and the field by 7 %
    CHECK_THAT(stated(9.0, 0.0), !Catch::Contains("eta"));
    // A small region is depressed on average: its energy falls by twice the uplift times the mean.
    CHECK_THAT(stated(12.0, 200.0, 8.0), Catch::Contains("eta by 11 %")); // (200/201)^2 (161/144)
    c.domain.edges = DomainEdges::open;
    CHECK(stated(9.0, 0.0).empty());
    CHECK(image_uplift_text(c).empty());
}

TEST_CASE("the uplift by images begins as the flow from rest and ends at the static displacement",
          "[warnings]") {
    Case c = small_domain();
    c.scene.load.modulation.envelope = {};
    c.scene.load.footprint = GaussianFootprint{1e-3};
    c.scene.medium = test::half_space(test::tissue(1500.0, 1.0)); // c_s = 5 m/s
    const double sigma_m = 1e-3 / 2.3548, area_m2 = 20e-3 * 10e-3;
    const double radius_m = 0.785398 * area_m2 / std::hypot(20e-3, 10e-3); // of the disc, 7 mm
    const double force_N = c.scene.load.peak_Pa * 6.283185 * sigma_m * sigma_m;
    c.time = {.frames = 400, .interval_s = 1e-4};
    const std::vector<double> uplift_m = image_uplift_m(c);
    // F t^2/(2 rho A R) while shear waves are within a tenth of R^2: 2 of 7 mm after .4 ms, of
    // which .1 ms pass until P waves have crossed the domain. Viscosity and the sampling change it
    // too.
    const double early_s = 0.3e-3;
    const double flow_m =
        force_N * early_s * (early_s + 2 * 0.1e-3) / (2.0 * 1000.0 * area_m2 * radius_m);
    CHECK(uplift_m[3] == Approx(flow_m).epsilon(0.15));
    // F/(4 pi mu r), integrated over the disc, per area of the domain.
    const double static_m = force_N * radius_m / (2.0 * 25e3 * area_m2);
    CHECK(uplift_m.back() == Approx(static_m).epsilon(0.02)); // waves in the modes decay as 1/t
}

TEST_CASE("warnings of the solver and of the receptors are kept with their keys", "[warnings]") {
    const Remark capped{Severity::warning, "solver.spectral.contrast_cap", "capped at 1000 times"};
    const auto warnings = pipeline::case_warnings(
        small_domain(),
        {.solver = {.warnings = {capped}},
         .afferents = {"afferents.pins_mm: pins of radius 1 mm overlap: use 0.5"}},
        check(small_domain()));
    CHECK(std::ranges::find(warnings, capped) != warnings.end());
    CHECK(warnings.back() ==
          Remark{Severity::warning, "afferents.pins_mm", "pins of radius 1 mm overlap: use 0.5"});
    CHECK(storage::warnings_in(storage::warnings_text(warnings)) == warnings);
    CHECK(storage::warnings_in("not JSON").empty());
}

} // namespace test_case_warnings
