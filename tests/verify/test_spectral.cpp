// SPDX-License-Identifier: BSD-3-Clause
// Engine "spectral" compared with the exact engine for the required medium: c_p = 1500 m/s, c_s = 5
// m/s, 12 mm on a rigid base, 0.5 Pa s, a 3 mm focus at 7 m/s switched on at t = 0.
#include "support/orders.hpp"
#include "support/spectral_cases.hpp"
#include "support/volume_store.hpp"

#include <catch2/catch.hpp>

namespace test_spectral {

using namespace shearwake;
using test::with_step;

static Case required_case() {
    Case c = test::focus_over_rigid_base(0.5, {12e-3}, -14e-3, 300e-3);
    c.domain = {48, 36, 0.75e-3, 0.0};
    c.time = {40, 100e-6};
    c.measure.at_s = 4e-3;
    c.measure.settled_after_s = 1e-3;
    c.measure.depths_m = {0.0, 2.3e-3};
    return c;
}

/// Relative L2 differences of the fields at 4 ms, at the surface and at depth.
static std::pair<double, double> difference(const Case& c, const Case& exact) {
    const auto a = test::frames_of(c), b = test::frames_of(exact);
    return {test::relative_l2(a.at(39), b.at(39)), test::relative_l2(a.at(39, 1), b.at(39, 1))};
}

static Case exact_of(Case c) {
    c.solver = LayeredOptions{.time_step_s = 12.5e-6};
    return c;
}

TEST_CASE("engine spectral agrees with layered within 0.1 % at a step of 25 us", "[verify]") {
    const Case c = required_case();
    const auto [surface, below] = difference(with_step(c, 25e-6), exact_of(c));
    CAPTURE(surface, below);
    CHECK(surface < 1e-3); // required; observed 1.2e-4
    CHECK(below < 1e-3);
}

TEST_CASE("engine spectral converges to layered with second order in the step", "[verify]") {
    // Shear is of fourth order, compressional and viscous forces of second order, which limits the
    // total.
    Case c = required_case();
    double step_s = 100e-6, order = 9.0;
    std::string load = "load switched on at once";
    SECTION("switched on instantly") {}
    SECTION("switched on gradually, with shorter steps") {
        load = "load switched on gradually";
        // If switched on instantly, compressional waves travel up and down, too: 31 kHz, which
        // steps of about 10 us do not resolve, 6e-6 of the field.
        c.scene.load.modulation.envelope = {{RampGain{3e-3}}};
        step_s = 50e-6;
    }
    const Case exact = exact_of(c);
    double error = difference(with_step(c, step_s), exact).first;
    for (int n = 0; n < 3; ++n) {
        step_s /= 2.0;
        const double halved = difference(with_step(c, step_s), exact).first;
        CAPTURE(step_s, error, halved);
        order = std::min(order, std::log2(error / halved));
        if (step_s == 50e-6) CHECK(halved < 3e-3); // required; observed 1e-3
        error = halved;
    }
    test::check_order("spectral, time step, " + load, 2.0, order, 0.2); // required
}

TEST_CASE("switching off the load between two steps preserves the order", "[verify][extended]") {
    Case c = required_case();
    test::travel_of(c).path = Curve({-11e-3, 0.0}, {8.3e-3, 0.0}); // 2.757 ms
    Case exact = c;
    exact.solver = LayeredOptions{.time_step_s = 3.125e-6};
    const double at_25 = difference(with_step(c, 25e-6), exact).first;
    const double at_12 = difference(with_step(c, 12.5e-6), exact).first;
    CAPTURE(at_25, at_12);
    CHECK(at_25 < 1e-3); // as for a continuing load
    test::check_order("spectral, time step, load ends between steps", 2.0, std::log2(at_25 / at_12),
                      0.2);
}

TEST_CASE("engine spectral is stable at any step and for layers of any contrast", "[verify]") {
    Case c = required_case();
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), c.scene.medium.layers[0]);
    c.scene.medium.layers[0].thickness_m = 0.5e-3;
    c.scene.medium.layers[0].c_s_m_s = 50.0; // 100 times stiffer
    const double reference = test::largest(test::last_frame(exact_of(c)));
    // An unstable mode would be larger by orders of magnitude.
    CHECK(test::largest(test::last_frame(with_step(c, 100e-6))) < 2.0 * reference);
}

TEST_CASE("engine spectral agrees with layered for stiffness ratios of one hundred",
          "[verify][extended]") {
    Case c = required_case();
    Layer stiff = c.scene.medium.layers[0], soft = stiff;
    stiff.c_s_m_s = 50.0;
    const auto surface = [&] { return difference(with_step(c, 25e-6), exact_of(c)).first; };
    SECTION("stiff skin") {
        stiff.thickness_m = 0.5e-3;
        soft.thickness_m = 4e-3;
        c.scene.medium.layers = {stiff, soft, stiff};
    }
    SECTION("a stiff sheet below") {
        stiff.thickness_m = 1.5e-3;
        soft.thickness_m = 3e-3;
        c.scene.medium.layers = {soft, stiff, soft};
    }
    CHECK(surface() < 0.01); // required
}

TEST_CASE("engine spectral reproduces the table of layered for the medium of the quickstart",
          "[verify][extended]") {
    Case c = required_case();
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 400.0}}};
    c.measure.depths_m = {0.0};
    const auto columns = [](const Case& of) {
        return test::columns_of(of, *engines::make_engine(of.solver), test::alone());
    };
    const auto a = columns(with_step(c, 25e-6)), b = columns(exact_of(c));
    for (const char* name : {"eta_period_1", "ipr_abs_period_mm2", "participation_period_mm2",
                             "focal_rms_um", "peak_um"}) {
        CAPTURE(name);
        CHECK(a.at(name) == Approx(b.at(name)).epsilon(0.01)); // required
    }
}

TEST_CASE("a volume snapshot is continuous with the surface and free of divergence", "[verify]") {
    Case c = with_step(required_case(), 25e-6);
    c.record.volumes_s = {c.time.frame_s(29)};
    c.record.volume_fields = {VolumeField::u};
    const auto store = test::frames_of<test::VolumeStore>(c);
    CHECK(store.at(0, 0, 2, 0) ==
          store.FrameStore::at(29)); // the same transform of the same numbers
    CHECK(store.z_m().front() == 0.0);
    CHECK(store.z_m().back() == Approx(12e-3));

    // c_p is 300 c_s: div u is negligible compared with its terms, except for the error of the
    // differences used here.
    const std::ptrdiff_t nx = c.domain.nx, ny = c.domain.ny;
    const auto at = [&](std::size_t component, std::size_t level, std::ptrdiff_t i,
                        std::ptrdiff_t j) {
        return store.at(0, 0, component, level)[static_cast<std::size_t>(i * ny + j)];
    };
    double divergence = 0.0, vertical = 0.0;
    for (std::size_t level = 0; level + 1 < store.z_m().size(); ++level) {
        const double dz_m = store.z_m()[level + 1] - store.z_m()[level];
        for (std::ptrdiff_t i = 1; i + 1 < nx; ++i) {
            for (std::ptrdiff_t j = 1; j + 1 < ny; ++j) {
                double horizontal = 0.0; // mean of the two levels, central differences
                for (const std::size_t l : {level, level + 1})
                    horizontal += (at(0, l, i + 1, j) - at(0, l, i - 1, j) + at(1, l, i, j + 1) -
                                   at(1, l, i, j - 1)) /
                                  (4.0 * c.domain.spacing_m);
                const double down = (at(2, level + 1, i, j) - at(2, level, i, j)) / dz_m;
                divergence += dz_m * std::pow(horizontal + down, 2);
                vertical += dz_m * down * down;
            }
        }
    }
    // Central differences have an error of (k h)^2 / 6, 0.07 at the 1/e wavenumber of the
    // footprint, 0.86 / mm. A component of wrong sign or position would cause an error of about 1.
    CHECK(std::sqrt(divergence / vertical) < 0.1); // observed 0.05
}

} // namespace test_spectral
