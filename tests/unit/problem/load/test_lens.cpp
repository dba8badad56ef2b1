// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/load/load_pattern.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <cstring>
#include <map>
#include <numbers>

namespace test_lens {

using namespace shearwake;

using Complex = std::complex<double>;
constexpr double two_pi = 2.0 * std::numbers::pi;

/// 100 mm wide, 120 mm above the skin, with two foci.
static LensFootprint two_foci() {
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
static double pixel_at_m(const LensFootprint& lens, std::ptrdiff_t pixels, std::ptrdiff_t i) {
    return (static_cast<double>(i) - 0.5 * static_cast<double>(pixels - 1)) * lens.pixel_m;
}

/// The Rayleigh-Sommerfeld integral of the first kind over the squares of the pixels: the
/// derivative of the Green's function by the midpoint rule with n x n and 2n x 2n points per pixel,
/// extrapolated to an error of the order h^4.
static Complex rayleigh(const LensFootprint& lens, const LensDesign& design, Vec2 at) {
    const Complex k(two_pi / wavelength_m(lens),
                    lens.absorption_dB_m / (20.0 * std::numbers::log10e));
    const auto with = [&](int parts) {
        const double step_m = lens.pixel_m / parts, z = lens.distance_m;
        Complex sum = 0.0;
        for (std::ptrdiff_t i = 0; i < parts * design.pixels; ++i)
            for (std::ptrdiff_t j = 0; j < parts * design.pixels; ++j) {
                const double phase =
                    design
                        .phase_rad[static_cast<std::size_t>(i / parts * design.pixels + j / parts)];
                if (std::isnan(phase)) continue;
                const double middle = 0.5 * static_cast<double>(parts * design.pixels - 1);
                const double r = std::hypot(at.x - step_m * (static_cast<double>(i) - middle),
                                            at.y - step_m * (static_cast<double>(j) - middle), z);
                // -d/dz of e^{ikr} / (2 pi r)
                sum += std::polar(step_m * step_m / two_pi, phase) *
                       std::exp(Complex(0.0, 1.0) * k * r) / r * (1.0 / r - Complex(0.0, 1.0) * k) *
                       z / r;
            }
        return sum;
    };
    // 12 parts of at most a twelfth of the wavelength or of the distance.
    const int parts = static_cast<int>(
        std::ceil(12.0 * lens.pixel_m / std::min(wavelength_m(lens), lens.distance_m)));
    return (4.0 * with(2 * parts) - with(parts)) / 3.0;
}

static double energy_of(const std::vector<Complex>& field) {
    double sum = 0.0;
    for (const Complex& p : field)
        sum += std::norm(p);
    return sum;
}

TEST_CASE("the field of a lens is the Rayleigh integral over its square pixels", "[lens]") {
    LensFootprint lens = two_foci();
    const auto [aperture_mm, distance_mm, pixel_mm] = GENERATE(table<double, double, double>({
        {100.0, 120.0, 2.163},
        {100.0, 50.0, 2.16},
        {100.0, 50.0, 8.0}, // nearly a wavelength
        {60.0, 200.0, 4.0},
        {40.0, 15.0, 3.0},
        {20.0, 5.0, 5.0}, // evanescent waves reach the skin
    }));
    CAPTURE(aperture_mm, distance_mm, pixel_mm);
    lens.aperture_m = 1e-3 * aperture_mm;
    lens.distance_m = 1e-3 * distance_mm;
    lens.pixel_m = 1e-3 * pixel_mm;
    lens.iterations = 5;
    const LensDesign design = design_lens(lens);
    const std::vector<Complex> field = field_on_skin(lens, design.phase_rad);
    const LensLattice grid = lattice(lens);
    double peak = 0.0, worst = 0.0;
    for (const Complex& p : field)
        peak = std::max(peak, std::abs(p));
    const auto middle = grid.side / 2, end = grid.side - middle;
    for (const auto& [share_x, share_y] :
         {std::pair{0.0, 0.0}, {0.0, 0.35}, {-0.4, 0.1}, {0.3, 0.3}, {0.0, -1.0}, {1.0, 1.0}}) {
        const double reach = fading_end_m(lens.reach_m) / grid.spacing_m;
        const auto i = middle + static_cast<std::ptrdiff_t>(share_x * reach),
                   j = middle + static_cast<std::ptrdiff_t>(share_y * reach);
        REQUIRE(std::max(i, j) < middle + end);
        const Complex exact = rayleigh(lens, design, {grid.at_m(i), grid.at_m(j)});
        worst =
            std::max(worst, std::abs(field[static_cast<std::size_t>(i * grid.side + j)] - exact));
    }
    // The rule of four points over a cell of up to a quarter of the wavelength, 6e-7.
    CHECK(worst < 3e-6 * peak);
}

TEST_CASE("the pattern of a lens is |p|^2 also between its samples", "[lens]") {
    LensFootprint lens = two_foci();
    lens.pixel_m = 1e-3 * GENERATE(2.16, 6.0);
    lens.distance_m = 0.05;
    const LensDesign design = design_lens(lens);
    for (const Vec2 at : {Vec2{-0.0147, 0.0003}, {0.0151, 0.0098}, {0.001, -0.002}, {0.02, 0.03}}) {
        const double exact = std::norm(rayleigh(lens, design, at)) / (design.gain * design.gain);
        // The rule over a cell; the wave numbers of |p|^2 are below 2 k, those of the lattice.
        CHECK(value_at(design.pattern, at) ==
              Approx(exact * fading(lens.reach_m, norm(at))).margin(1e-5));
    }
    double peak = 0.0;
    for (const Vec2& focus : lens.foci_m)
        for (int n = 0; n < 41 * 41; ++n)
            peak = std::max(
                peak, value_at(design.pattern, focus + 1e-4 * Vec2{n / 41 - 20.0, n % 41 - 20.0}));
    CHECK(peak == Approx(1.0).margin(4e-4)); // 0.07 mm from the peak of a focus of 6 mm
}

TEST_CASE("a cell radiates the plane waves of a square", "[lens]") {
    // (2 pi)^-2 integral of sinc(kx h / 2) sinc(ky h / 2) h^2 e^{i (kx x + ky y + kz z)}: over the
    // angle of travelling waves, and over the arsinh of the decay of evanescent ones.
    constexpr std::ptrdiff_t side = 16;
    constexpr double h = 2e-3, z = 8e-3, k = 720.0;
    std::vector<Complex> field(side * side);
    field[8 * side + 8] = 1.0;
    PlanePropagation({k, 0.0}, {side, h, z}).forward(field);
    const auto sinc = [](double x) { return std::abs(x) < 1e-9 ? 1.0 : std::sin(x) / x; };
    const auto waves = [&](double x, double y, double lateral) {
        constexpr int directions = 240; // a trapezoidal rule over a period
        Complex sum = 0.0;
        for (int n = 0; n < directions; ++n) {
            const double kx = lateral * std::cos(two_pi * n / directions),
                         ky = lateral * std::sin(two_pi * n / directions);
            sum += sinc(0.5 * kx * h) * sinc(0.5 * ky * h) * std::polar(1.0, kx * x + ky * y);
        }
        return h * h / two_pi * sum / static_cast<double>(directions);
    };
    for (const auto& [i, j] : {std::pair{0, 0}, {1, 0}, {3, 2}, {-5, 7}}) {
        const double x = h * i, y = h * j;
        constexpr int steps = 4000;
        constexpr double decay_most = 5.0; // e^{-k z sinh 5} = e^{-427}
        Complex exact = 0.0;
        for (int n = 0; n < steps; ++n) {
            const double angle = (n + 0.5) / steps * 0.25 * two_pi,
                         t = (n + 0.5) / steps * decay_most;
            const double kz = k * std::cos(angle), decay = k * std::sinh(t);
            exact += waves(x, y, k * std::sin(angle)) * std::polar(1.0, kz * z) * kz * k *
                     std::sin(angle) * (0.25 * two_pi / steps);
            exact += waves(x, y, k * std::cosh(t)) * std::exp(-decay * z) * decay * k *
                     std::cosh(t) * (decay_most / steps);
        }
        const Complex computed = field[static_cast<std::size_t>((8 + i) * side + 8 + j)];
        CHECK(std::abs(computed - exact) < 1e-5 * std::abs(field[8 * side + 8])); // midpoint rule
    }
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
    const double on_axis =
        std::abs(field_on_skin(lens, phase_rad)[static_cast<std::size_t>(side / 2 * (side + 1))]);
    const double depth_m = focus_m - std::sqrt(focus_m * focus_m - radius_m * radius_m);
    const double z = lens.distance_m, rim = std::hypot(z - depth_m, radius_m);
    const double bowl =
        std::abs(std::polar(1.0, k * z) - std::polar(1.0, k * rim)) / std::abs(1.0 - z / focus_m);
    CHECK(on_axis == Approx(bowl).epsilon(0.01));
}

TEST_CASE("propagation without absorption loses only the energy of the steps of cells", "[lens]") {
    constexpr std::ptrdiff_t side = 180, margin = 40;
    constexpr double spacing_m = 2e-3, radius_m = 20e-3;
    PlanePropagation waves({720.0, 0.0}, {side, spacing_m, 0.1});
    std::vector<Complex> beam;
    for (std::ptrdiff_t i = 0; i < side; ++i)
        for (std::ptrdiff_t j = 0; j < side; ++j) {
            const double r = spacing_m * std::hypot(i - side / 2, j - side / 2) / radius_m;
            beam.push_back(std::exp(-r * r));
        }
    const double before = energy_of(beam);
    waves.forward(beam);
    // The beam is negligible 80 mm from its axis, so the field is valid 100 mm from it.
    double after = 0.0;
    for (std::ptrdiff_t i = margin; i < side - margin; ++i)
        for (std::ptrdiff_t j = margin; j < side - margin; ++j)
            after += std::norm(beam[static_cast<std::size_t>(i * side + j)]);
    // The mean of sinc^2(kx h / 2) over the beam, whose kx^2 has the mean 1 / radius^2, along each
    // axis. The rest of the energy is in evanescent waves.
    const double share = spacing_m / radius_m;
    const double along = 1.0 - share * share / 12.0 + std::pow(share, 4) / 120.0;
    CHECK(after == Approx(along * along * before).epsilon(3e-9)); // share^6 / 1344 each
}

TEST_CASE("the adjoint of the propagation is its adjoint", "[lens]") {
    constexpr std::ptrdiff_t side = 30;
    PlanePropagation waves({720.0, 0.2}, {side, 2e-3, 0.1});
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

} // namespace test_lens
