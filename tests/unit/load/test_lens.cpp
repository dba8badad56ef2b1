// SPDX-License-Identifier: BSD-3-Clause
#include "load/acoustics/air.hpp"
#include "load/acoustics/angular_spectrum.hpp"
#include "load/acoustics/lens_design.hpp"
#include "load/acoustics/lens_mesh.hpp"
#include "load/load_pattern.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

using namespace shearwake;

namespace {

using Complex = std::complex<double>;
constexpr double two_pi = 2.0 * std::numbers::pi;

/// 100 mm wide, 120 mm above the skin, with two foci.
LensFootprint two_foci() {
    LensFootprint lens;
    lens.aperture_m = 0.1;
    lens.distance_m = 0.12;
    lens.absorption_dB_m = 1.3;
    lens.pixel_m = 0.25 * wavelength_m(lens);
    lens.material_c_m_s = 1500.0;
    lens.material_density_kg_m3 = 1200.0;
    lens.foci_m = {{-0.015, 0.0}, {0.015, 0.01}};
    lens.reach_m = 0.05;
    lens.iterations = 30;
    return lens;
}

/// Coordinate of a pixel.
double pixel_at_m(const LensFootprint& lens, std::ptrdiff_t pixels, std::ptrdiff_t i) {
    return (static_cast<double>(i) - 0.5 * static_cast<double>(pixels - 1)) * lens.pixel_m;
}

/// The Rayleigh-Sommerfeld integral of the first kind over the pixels, each one a point.
Complex rayleigh(const LensFootprint& lens, const LensDesign& design, Vec2 at) {
    const Complex k(two_pi / wavelength_m(lens),
                    lens.absorption_dB_m / (20.0 * std::numbers::log10e));
    Complex sum = 0.0;
    for (std::ptrdiff_t i = 0; i < design.pixels; ++i)
        for (std::ptrdiff_t j = 0; j < design.pixels; ++j) {
            const double phase = design.phase_rad[static_cast<std::size_t>(i * design.pixels + j)];
            if (std::isnan(phase)) continue;
            const double r = std::hypot(at.x - pixel_at_m(lens, design.pixels, i),
                                        at.y - pixel_at_m(lens, design.pixels, j), lens.distance_m);
            sum += std::polar(1.0, phase) * std::exp(Complex(0.0, 1.0) * k * r) *
                   (1.0 / r - Complex(0.0, 1.0) * k) * lens.distance_m / (r * r);
        }
    return sum * lens.pixel_m * lens.pixel_m / two_pi;
}

double energy_of(const std::vector<Complex>& field) {
    double sum = 0.0;
    for (const Complex& p : field)
        sum += std::norm(p);
    return sum;
}

} // namespace

TEST_CASE("the angular spectrum of a lens agrees with the Rayleigh integral", "[lens]") {
    const LensFootprint lens = two_foci();
    const LensDesign design = design_lens(lens);
    const std::vector<Complex> field = field_on_skin(lens, design.phase_rad);
    const LensLattice grid = lattice(lens);
    double worst = 0.0, peak = 0.0;
    for (std::ptrdiff_t i = 0; i < grid.side; i += 3)
        for (std::ptrdiff_t j = 0; j < grid.side; j += 3) {
            const Vec2 at = {grid.at_m(i), grid.at_m(j)};
            if (norm(at) > lens.reach_m) continue;
            const Complex exact = rayleigh(lens, design, at);
            peak = std::max(peak, std::abs(exact));
            worst = std::max(worst,
                             std::abs(field[static_cast<std::size_t>(i * grid.side + j)] - exact));
        }
    CHECK(worst / peak < 1e-3); // the waves that the finite lattice fades out
}

TEST_CASE("a focusing lens produces the field of O'Neil's bowl on its axis", "[lens]") {
    // A flat lens and a bowl differ by 3/4 of (radius / distance)^2 = 0.5 %.
    LensFootprint lens = two_foci();
    lens.frequency_Hz = 200e3;
    lens.pixel_m = 0.25 * wavelength_m(lens);
    lens.absorption_dB_m = 0.0;
    lens.reach_m = 0.01;
    const double radius_m = 0.05, focus_m = 0.625, k = two_pi / wavelength_m(lens);
    lens.distance_m = GENERATE(0.5, 0.55, 0.6, 0.65);
    const std::ptrdiff_t pixels = pixels_along(lens);
    std::vector<double> phase_rad;
    for (std::ptrdiff_t i = 0; i < pixels; ++i)
        for (std::ptrdiff_t j = 0; j < pixels; ++j)
            phase_rad.push_back(-k * (std::hypot(pixel_at_m(lens, pixels, i),
                                                 pixel_at_m(lens, pixels, j), focus_m) -
                                      focus_m));
    const std::ptrdiff_t side = lattice(lens).side;
    const auto fine = refined(field_on_skin(lens, phase_rad), side, 2);
    const double on_axis =
        std::abs(fine[static_cast<std::size_t>((side - 1) * 2 * side + side - 1)]);
    const double depth_m = focus_m - std::sqrt(focus_m * focus_m - radius_m * radius_m);
    const double z = lens.distance_m, rim = std::hypot(z - depth_m, radius_m);
    const double bowl =
        std::abs(std::polar(1.0, k * z) - std::polar(1.0, k * rim)) / std::abs(1.0 - z / focus_m);
    CHECK(on_axis == Approx(bowl).epsilon(0.01));
}

TEST_CASE("propagation conserves the energy of a beam without absorption", "[lens]") {
    constexpr std::ptrdiff_t side = 96;
    constexpr double spacing_m = 2e-3;
    AngularSpectrum waves({720.0, 0.0}, {side, spacing_m, 0.1, 0.09});
    std::vector<Complex> beam;
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = 0; j < side; ++j) {
            const double r = spacing_m * std::hypot(i - 48, j - 48);
            beam.push_back(std::exp(-r * r / 4e-4)); // angles far below the fade-out
        }
    const double before = energy_of(beam);
    const std::vector<Complex> first = beam;
    waves.forward(beam);
    CHECK(energy_of(beam) == Approx(before).epsilon(1e-12));
    waves.adjoint(beam);
    double worst = 0.0;
    for (std::size_t n = 0; n < beam.size(); ++n)
        worst = std::max(worst, std::abs(beam[n] - first[n]));
    CHECK(worst < 1e-10); // the beam's spectrum at the angles of the fade-out
}

TEST_CASE("the adjoint of the propagation is its adjoint", "[lens]") {
    constexpr std::ptrdiff_t side = 30;
    AngularSpectrum waves({720.0, 0.2}, {side, 2e-3, 0.1, 0.025});
    std::vector<Complex> a, b;
    for (int n = 0; n < side * side; ++n) {
        a.emplace_back(std::sin(1.0 * n * n), std::cos(3.0 * n));
        b.emplace_back(std::cos(2.0 * n * n), std::sin(5.0 * n));
    }
    std::vector<Complex> there = a, back = b;
    waves.forward(there);
    waves.adjoint(back);
    Complex left = 0.0, right = 0.0;
    for (std::size_t n = 0; n < a.size(); ++n) {
        left += std::conj(b[n]) * there[n];
        right += std::conj(back[n]) * a[n];
    }
    CHECK(std::abs(left - right) < 1e-10 * std::abs(left)); // rounding
}

TEST_CASE("the error of a lens decreases in every iteration", "[lens]") {
    LensFootprint lens = two_foci();
    if (GENERATE(false, true)) {
        lens.foci_m.clear();
        lens.polygon_m = {{-0.02, -0.02}, {0.02, -0.02}, {0.0, 0.02}};
        lens.pixel_m *= 2.5; // several points per pixel
    }
    const LensDesign design = design_lens(lens);
    REQUIRE(design.errors.size() == 31);
    for (std::size_t n = 1; n < design.errors.size(); ++n)
        CHECK(design.errors[n] <= design.errors[n - 1] * (1.0 + 1e-12));
    CHECK(design.errors.back() < design.errors.front());
    CHECK(design.efficiency > 0.2);
    CHECK(design.efficiency < 1.0);
}

TEST_CASE("a lens presses at its foci and nowhere harder", "[lens]") {
    const LensFootprint lens = two_foci();
    const LensDesign design = design_lens(lens);
    CHECK(design.uniformity > 0.95); // both foci are equally far from the axis, within 3 mm
    for (const Vec2& focus : lens.foci_m)
        CHECK(value_at(design.pattern, focus) > 0.9);
    CHECK(*std::max_element(design.pattern.values.begin(), design.pattern.values.end()) <=
          1.0 + 1e-9);
    // The spot of a lens with a circular aperture is 1.03 wavelengths times distance / aperture
    // wide for small angles; two foci and an oblique one are wider.
    CHECK(design.width_m == Approx(focal_width_m(lens)).epsilon(0.2));
}

TEST_CASE("rounded phases are those of a lens with few levels", "[lens]") {
    LensFootprint lens = two_foci();
    lens.phase_levels = 4;
    const LensDesign design = design_lens(lens);
    for (const double phase : design.phase_rad)
        if (!std::isnan(phase))
            CHECK(std::remainder(phase, two_pi / 4.0) == Approx(0.0).margin(1e-12));
    CHECK(design.errors.back() > design.errors[design.errors.size() - 2]);
}

TEST_CASE("thickness gives the phase of the lens", "[lens]") {
    LensFootprint lens = two_foci();
    lens.material_c_m_s = GENERATE(100.0, 1500.0); // slower and faster than air
    for (const double phase : {0.0, 1.0, 3.0, 6.0}) {
        const double thickness = thickness_m(lens, phase) - lens.base_m;
        const double given = two_pi * lens.frequency_Hz *
                             (1.0 / lens.material_c_m_s - 1.0 / lens.sound_speed_m_s) * thickness;
        CHECK(thickness >= 0.0);
        CHECK(std::remainder(given - phase, two_pi) == Approx(0.0).margin(1e-9));
    }
}

TEST_CASE("the load of a lens has the spectrum of its pattern", "[lens][load]") {
    Load load;
    load.peak_Pa = 1.0;
    load.footprint = two_foci();
    load.modulation.trajectory = {{Hold{{0.004, -0.003}}}};
    LoadPattern pattern(load, 1.0);
    CHECK_FALSE(pattern.changes());
    const double kx = 300.0, ky = -150.0;
    Complex spectrum_there;
    pattern.spectra(ky, {&kx, 1}, {&spectrum_there, 1});
    spectrum_there *= std::polar(1.0, -(kx * pattern.origin_m().x + ky * pattern.origin_m().y));
    const Patch patch = design_lens(two_foci()).pattern;
    Complex sum = 0.0;
    for (std::ptrdiff_t i = 0; i < patch.side; ++i)
        for (std::ptrdiff_t j = 0; j < patch.side; ++j) {
            const Vec2 at = patch.origin_m + Vec2{0.004, -0.003} +
                            patch.spacing_m * Vec2{static_cast<double>(i), static_cast<double>(j)};
            sum += patch.values[static_cast<std::size_t>(i * patch.side + j)] *
                   std::polar(patch.spacing_m * patch.spacing_m, -(kx * at.x + ky * at.y));
        }
    CHECK(std::abs(spectrum_there - sum) < 1e-12 * std::abs(sum)); // rounding
}

TEST_CASE("absorption in air is that of ISO 9613", "[lens]") {
    // Table 2 of ISO 9613-2, 10 degrees and 70 %, in dB/km, rounded to three digits; exact
    // frequencies of the octaves.
    CHECK(1e3 * air_absorption_dB_m(1000.0, 283.15, 0.7) == Approx(3.7).margin(0.06));
    CHECK(1e3 * air_absorption_dB_m(3981.07, 283.15, 0.7) == Approx(32.8).margin(0.1));
    CHECK(1e3 * air_absorption_dB_m(7943.28, 283.15, 0.7) == Approx(117.0).margin(0.6));
}

TEST_CASE("the surface of a lens is closed and encloses its volume", "[lens]") {
    // Missing columns, equal neighbours, and columns that touch only at an edge.
    const HeightMap map{
        4,
        2e-3,
        {1e-3, 2e-3, 0, 3e-3, 2e-3, 1e-3, 4e-3, 0, 2e-3, 2e-3, 1e-3, 5e-3, 0, 3e-3, 0, 2e-3}};
    using Point = std::array<double, 3>;
    std::map<std::pair<Point, Point>, int> edges;
    double volume = 0.0;
    const auto triangles = surface_of(map);
    for (const Triangle& t : triangles) {
        for (std::size_t n = 0; n < 3; ++n) {
            const Vec3 a = t[n], b = t[(n + 1) % 3];
            ++edges[{{a.x, a.y, a.z}, {b.x, b.y, b.z}}];
        }
        volume += (t[0].x * (t[1].y * t[2].z - t[1].z * t[2].y) -
                   t[0].y * (t[1].x * t[2].z - t[1].z * t[2].x) +
                   t[0].z * (t[1].x * t[2].y - t[1].y * t[2].x)) /
                  6.0;
    }
    for (const auto& [edge, count] : edges)
        CHECK(edges[{edge.second, edge.first}] == count);
    double expected = 0.0;
    for (const double height : map.heights_m)
        expected += height * map.pixel_m * map.pixel_m;
    CHECK(volume == Approx(expected).epsilon(1e-12));
    const std::string stl = binary_stl(triangles);
    CHECK(stl.size() == 84 + 50 * triangles.size());
    std::uint32_t count = 0;
    std::memcpy(&count, stl.data() + 80, 4);
    CHECK(count == triangles.size());
}
