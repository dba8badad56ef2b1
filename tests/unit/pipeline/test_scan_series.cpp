// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/recording.hpp"

#include <algorithm>
#include <array>
#include <catch2/catch.hpp>
#include <cmath>
#include <vector>

namespace test_scan_series {

using namespace shearwake;

constexpr Vec2 wave_rad_m{150.0, -120.0};
constexpr Vec3 amplitudes_m{2e-6, -3e-6, 5e-6};

/// 60 mm x 48 mm, two frames, four points between the nodes.
static Case scanned() {
    Case c;
    c.domain.nx = 60;
    c.domain.ny = 48;
    c.domain.spacing_m = 1e-3;
    c.time = {.frames = 2, .interval_s = 1e-4};
    c.vibrometer.emplace();
    c.vibrometer->points_m = {{0.0, 0.0}, {3.3e-3, -7.7e-3}, {-12.5e-3, 4.1e-3}, {8e-3, 9e-3}};
    return c;
}

/// One component of a wave that runs across the plane, at a frame.
static double wave_m(double amplitude_m, Vec2 at_m, std::ptrdiff_t frame) {
    return amplitude_m * std::cos(wave_rad_m.x * at_m.x + wave_rad_m.y * at_m.y -
                                  0.7 * static_cast<double>(frame));
}

static std::vector<double> motion_in_sight_m(const Case& c) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    pipeline::ScanSeries series(c, alone);
    series.begin({0, c.domain.nx});
    for (std::ptrdiff_t frame = 0; frame < c.time.frames; ++frame)
        for (std::size_t component = 0; component < 3; ++component) {
            const double amplitude_m =
                std::array{amplitudes_m.x, amplitudes_m.y, amplitudes_m.z}[component];
            std::vector<double> plane;
            for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
                for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j)
                    plane.push_back(wave_m(amplitude_m, {c.domain.x_m(i), c.domain.y_m(j)}, frame));
            const View2<const double> view(plane.data(), c.domain.nx, c.domain.ny, c.domain.ny);
            if (component == 2)
                series.frame({.number = frame, .depth = 0, .u_z_m = view});
            else
                series.tangential({.number = frame, .component = component, .u_m = view});
        }
    series.finish();
    return series.displacements_m();
}

/// The largest difference from the motion along the line of sight, relative to its amplitude.
static double error_of(const Case& c, double spot_factor) {
    const VibrometerOptions& o = *c.vibrometer;
    const Vec3 along = o.line_of_sight();
    const double amplitude_m =
        along.x * amplitudes_m.x + along.y * amplitudes_m.y + along.z * amplitudes_m.z;
    const std::vector<double> found = motion_in_sight_m(c);
    double worst = 0.0;
    for (std::size_t point = 0; point < o.points_m.size(); ++point)
        for (std::ptrdiff_t frame = 0; frame < c.time.frames; ++frame) {
            const double expected =
                wave_m(spot_factor * amplitude_m,
                       o.points_m[point] + Vec2{o.offset_x_m, o.offset_y_m}, frame);
            worst = std::max(
                worst, std::abs(found[2 * point + static_cast<std::size_t>(frame)] - expected));
        }
    return worst / std::abs(amplitude_m);
}

// Cubic interpolation in both directions: 2 (k h)^4 3 / 128 with k h = 0.15.
constexpr double of_interpolation = 3e-5;

TEST_CASE("a vibrometer records all components along its line of sight", "[vibrometer]") {
    Case c = scanned();
    CHECK(error_of(c, 1.0) < of_interpolation);
    c.vibrometer->tilt_rad = 0.5;
    c.vibrometer->azimuth_rad = GENERATE(0.0, 0.4, 2.0, -1.0);
    CHECK(error_of(c, 1.0) < of_interpolation);
}

TEST_CASE("misaligned points are recorded where they are", "[vibrometer]") {
    Case c = scanned();
    c.vibrometer->offset_x_m = 2.6e-3;
    c.vibrometer->offset_y_m = -1.2e-3;
    CHECK(error_of(c, 1.0) < of_interpolation);
}

TEST_CASE("the spot averages the motion over a disc", "[vibrometer]") {
    Case c = scanned();
    c.vibrometer->spot_m = GENERATE(0.08e-3, 2e-3, 4e-3);
    const double kr = norm(wave_rad_m) * 0.5 * c.vibrometer->spot_m; // at most 0.4
    // The rule of degree 5 neglects (k r)^6 / 2304 and more.
    CHECK(error_of(c, 2.0 * std::cyl_bessel_j(1.0, kr) / kr) < of_interpolation);
}

} // namespace test_scan_series
