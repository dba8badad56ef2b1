// SPDX-License-Identifier: BSD-3-Clause
// The stress that the engine passes to receptors, below a focus that has been at rest long enough.
#include "support/cases.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace test_neural_stress {

using namespace shearwake;

TEST_CASE("stress below a resting focus equals that of a static load on a half-space", "[neural]") {
    Case c;
    Layer skin = test::tissue(1500.0, 10.0); // thick and viscous enough to come to rest
    c.scene.medium = test::half_space(skin);
    c.scene.load.peak_Pa = 100.0;
    c.scene.load.footprint = GaussianFootprint{6e-3};
    c.scene.load.modulation = {
        .kind = "AM", .trajectory = {{Hold{}}}, .envelope = {{RampGain{.duration_s = 10e-3}}}};
    c.domain = {64, 64, 1.5e-3, 0.0};
    c.time = {300, 200e-6};
    c.measure = {.at_s = 60e-3, .settled_after_s = 30e-3, .focal_radius_m = 6e-3};
    if (GENERATE(false, true)) c.solver = SpectralOptions{.time_step_s = 200e-6};
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    const Comm alone = Comm::world().split(Comm::world().rank());
    pipeline::SurfaceRecorder recorder(c, alone, {});
    recorder.record_stress({{}, {}, {}, {3e-3, 0.0}, {1.0, 0.0}}, {0, 1, 2, 2, 2});
    engines::make_engine(c.solver)->run(c, alone, recorder);
    recorder.finish();

    // sigma_zz(z) = peak int s^2 k exp(-s^2 k^2/2) (1 + k z) exp(-k z) dk on the axis.
    const double s_m = 6e-3 / (2.0 * std::sqrt(2.0 * std::log(2.0)));
    const auto expected_Pa = [&](double z_m) {
        double sum = 0.0;
        const double dk = 1.0;
        for (double k = 0.5 * dk; k < 6.0 / s_m; k += dk)
            sum += s_m * s_m * k * std::exp(-0.5 * s_m * s_m * k * k) * (1.0 + k * z_m) *
                   std::exp(-k * z_m) * dk;
        return 100.0 * sum;
    };
    const auto& stresses = recorder.stresses_Pa();
    // The load of the periodic images contributes pi s^2 2 / (96 mm)^2 = 0.4 % of the peak. Cubic
    // interpolation is exact at grid points.
    for (std::size_t i = 0; i < 3; ++i)
        CHECK(stresses[i].u_m.back() == Approx(expected_Pa(stress_depths_m(c)[i])).epsilon(0.01));
    CHECK(stresses[3].u_m.back() < 0.8 * stresses[2].u_m.back());
    CHECK(stresses[4].u_m.back() == 0.0); // outside of the domain the stress is 0
}

} // namespace test_neural_stress
