// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/array_field.hpp"

#include "base/error.hpp"
#include "problem/load/load_pattern.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_array_field {

using namespace shearwake;

using Complex = std::complex<double>;

/// 16 x 16 pistons at 20 cm, the pattern kept up to 41 mm from the focus.
static ArrayFootprint board(double distance_m = 0.2) {
    return {.distance_m = distance_m, .reach_m = 0.041};
}

static Load load_of(const Footprint& footprint, const Trajectory& trajectory) {
    Load load;
    load.peak_Pa = 1.0;
    load.footprint = footprint;
    load.modulation.trajectory = trajectory;
    return load;
}

static Trajectory at(Vec2 place_m) {
    return {{Hold{place_m}}};
}

/// |p|^2 at `there` of pistons focused at `focus`, relative to a focus straight below, summed
/// piston by piston.
static double slow_twin(const ArrayFootprint& array, Vec2 focus, Vec2 there) {
    Complex p = 0.0;
    double peak = 0.0;
    for (int row = 0; row < array.rows; ++row)
        for (int column = 0; column < array.columns; ++column) {
            const Vec2 place = {(column - 7.5) * array.pitch_m, (row - 7.5) * array.pitch_m};
            const Complex to_focus = piston_pressure(array, norm(focus - place));
            p += std::conj(to_focus) / std::abs(to_focus) *
                 piston_pressure(array, norm(there - place));
            peak += std::abs(piston_pressure(array, norm(place)));
        }
    return std::norm(p) / (peak * peak);
}

static double first_force_N(const Load& load) {
    const double zero = 0.0;
    return forces_N(load, {&zero, 1}).front();
}

TEST_CASE("the focus of a 16 x 16 array is as wide as it is known to be", "[array]") {
    // Design figures to a tenth of a millimetre.
    CHECK(fwhm_m(Footprint(board(0.15))) == Approx(8.2e-3).margin(0.05e-3));
    CHECK(fwhm_m(Footprint(board(0.20))) == Approx(10.2e-3).margin(0.05e-3));
    CHECK(fwhm_m(Footprint(board(0.30))) == Approx(14.5e-3).margin(0.05e-3));
}

TEST_CASE("the pistons' directivity is that of a disc", "[array]") {
    const ArrayFootprint array = board();
    // 2 J1(x) / x by its power series at x = k a sin(theta).
    const double offset_m = GENERATE(0.0, 0.03, 0.15);
    const double r = std::hypot(offset_m, 0.2);
    const double x = 2.0 * std::numbers::pi * 40e3 / array.sound_speed_m_s * 4.5e-3 * offset_m / r;
    double term = 1.0, sum = 0.0;
    for (int n = 0; n < 20; ++n) {
        sum += term;
        term *= -x * x / (4.0 * (n + 1.0) * (n + 2.0));
    }
    CHECK(std::abs(piston_pressure(array, offset_m)) == Approx(std::abs(sum) / r).epsilon(1e-12));
}

TEST_CASE("a steered pattern is the sum of all pistons", "[array]") {
    const ArrayFootprint array = board();
    const Vec2 focus = GENERATE(Vec2{0.0, 0.0}, Vec2{0.03, -0.012}, Vec2{-0.049, 0.0});
    const Patch patch = ArrayField(array, 0.05).pattern(focus, {&focus, 1});
    for (const auto& [i, j] : {std::pair{46, 46}, std::pair{40, 50}, std::pair{60, 20}}) {
        const Vec2 there =
            patch.origin_m + patch.spacing_m * Vec2{static_cast<double>(i), static_cast<double>(j)};
        const double expected =
            slow_twin(array, focus, there) * fading(array.reach_m, norm(there - focus));
        // Roundings of phases of 150 rad, some 1e-13.
        CHECK(patch.values[static_cast<std::size_t>(i * patch.side + j)] ==
              Approx(expected).epsilon(0).margin(1e-12));
    }
}

TEST_CASE("a pattern beyond what was asked for is refused", "[array]") {
    const ArrayField field(board(), 0.02);
    const Vec2 near = {0.02, -0.02}, far = {0.0, 0.05};
    CHECK_NOTHROW(field.pattern(near, {&near, 1}));
    CHECK_THROWS_AS(field.pattern(far, {&far, 1}), Error);
}

TEST_CASE("an array's samples and spectrum are a Fourier pair", "[array]") {
    const Vec2 focus = GENERATE(Vec2{0.0, 0.0}, Vec2{0.03, -0.012});
    const ArrayFootprint array = board();
    LoadPattern pattern(load_of(array, at(focus)), 0.0);
    // Back from the spectrum, between the samples: on a box in which the patch, 130 mm wide, does
    // not overlap its images.
    const double box_m = 0.16, dk = 2.0 * std::numbers::pi / box_m;
    const auto last = static_cast<int>(pattern.band_rad_m() / dk);
    std::vector<double> kx;
    for (int m = -last; m <= last; ++m)
        kx.push_back(m * dk);
    std::vector<Complex> row(kx.size());
    const std::vector<Vec2> places = {focus, focus + Vec2{0.0037, 0.0021},
                                      focus + Vec2{-0.0111, 0.0}, focus + Vec2{0.0203, -0.0307},
                                      focus + Vec2{0.0402, 0.0013}};
    std::vector<Complex> back(places.size());
    for (const double ky : kx) {
        pattern.spectra(ky, kx, row);
        for (std::size_t p = 0; p < places.size(); ++p) {
            const Vec2 off = places[p] - pattern.origin_m();
            for (std::size_t i = 0; i < kx.size(); ++i)
                back[p] += row[i] * std::polar(1.0, kx[i] * off.x + ky * off.y);
        }
    }
    for (std::size_t p = 0; p < places.size(); ++p) {
        const double expected =
            slow_twin(array, focus, places[p]) * fading(array.reach_m, norm(places[p] - focus));
        CHECK(std::abs(back[p] / (box_m * box_m) - expected) < 1e-10); // of the peak, 1
    }
}

TEST_CASE("an array's pattern straight below is the footprint", "[array]") {
    const Footprint footprint = board();
    CHECK(pressure(footprint, 0.0, 0.0) == Approx(1.0).epsilon(1e-10));
    CHECK(pressure(footprint, 0.5 * fwhm_m(footprint), 0.0) == Approx(0.5).epsilon(1e-9));
    CHECK(pressure(footprint, 0.004, -0.007) ==
          Approx(slow_twin(board(), {}, {0.004, -0.007})).epsilon(1e-8)); // hardly faded there
    const double k = bandwidth_rad_m(footprint, 1e-3);
    CHECK(spectrum(footprint, 1.01 * k, 0.0) < 1e-3 * spectrum(footprint, 0.0, 0.0));
    CHECK(k > 2.0 / fwhm_m(footprint));
    CHECK(k < 1100.0); // twice k sin(angle to the outermost piston) and a little
}

TEST_CASE("rounding phases to few levels reduces the peak as predicted by theory", "[array]") {
    // Errors even over a step weaken the pressure by sin(pi / n) / (pi / n). 256 pistons of which
    // eight each have the same phase: within a tenth.
    const Vec2 focus = {0.0131, 0.0077};
    const auto strength = [&](int levels) {
        ArrayFootprint array = board();
        array.phase_levels = levels;
        const Patch patch = ArrayField(array, 0.02).pattern(focus, {&focus, 1});
        return *std::max_element(patch.values.begin(), patch.values.end());
    };
    const int levels = GENERATE(2, 4, 8);
    const double x = std::numbers::pi / levels;
    CHECK(strength(levels) / strength(0) == Approx(std::pow(std::sin(x) / x, 2)).epsilon(0.1));
    CHECK(strength(256) / strength(0) == Approx(1.0).epsilon(1e-2));
    ArrayFootprint array = board();
    const auto exact = ArrayField(array, 0.02).drives({&focus, 1});
    array.phase_levels = levels;
    const auto rounded = ArrayField(array, 0.02).drives({&focus, 1});
    double worst_rad = 0.0;
    for (std::size_t n = 0; n < exact.size(); ++n)
        worst_rad = std::max(worst_rad, std::abs(std::arg(rounded[n] / exact[n])));
    CHECK(worst_rad <= x * (1.0 + 1e-12)); // half a step
}

TEST_CASE("the pattern of an array is that of the discs of its pistons", "[array]") {
    const ArrayFootprint array = board(GENERATE(0.1, 0.2));
    const double k = 2.0 * std::numbers::pi * array.frequency_Hz / array.sound_speed_m_s;
    // The mean of e^{ikr} / r over a disc, by the midpoint rule in rings of equal area.
    const auto disc = [&](Vec2 off) {
        constexpr int rings = 10, angles = 24;
        Complex sum = 0.0;
        for (int n = 0; n < rings * angles; ++n) {
            const double radius_m = array.radius_m * std::sqrt((n / angles + 0.5) / rings);
            const double angle = 2.0 * std::numbers::pi * n / angles;
            const double r = std::hypot(off.x - radius_m * std::cos(angle),
                                        off.y - radius_m * std::sin(angle), array.distance_m);
            sum += std::polar(1.0 / r, k * r);
        }
        return sum / static_cast<double>(rings * angles);
    };
    const Vec2 focus = {0.02, 0.01};
    for (const Vec2 off : {Vec2{}, {0.004, 0.002}, {-0.005, 0.003}, {0.015, -0.01}}) {
        Complex p = 0.0;
        double peak = 0.0;
        for (int row = 0; row < array.rows; ++row)
            for (int column = 0; column < array.columns; ++column) {
                const Vec2 place = {(column - 7.5) * array.pitch_m, (row - 7.5) * array.pitch_m};
                const Complex to_focus = piston_pressure(array, norm(focus - place));
                p += std::conj(to_focus) / std::abs(to_focus) * disc(focus + off - place);
                peak += std::abs(piston_pressure(array, norm(place)));
            }
        // The directivity is that of a far field, whose phase is in error by k a^2 / (4 r) = 0.04
        // at 0.1 m. An eighth of it differs between the pistons of this steered array.
        CHECK(slow_twin(array, focus, focus + off) ==
              Approx(std::norm(p) / (peak * peak)).margin(5e-4 / array.distance_m));
    }
}

TEST_CASE("the force of a steered array is the integral of its pressure", "[array]") {
    ArrayFootprint array = board(GENERATE(0.1, 0.2));
    array.reach_m = 0.02;
    const Vec2 focus = {0.02, 0.01};
    // On a lattice that is not that of the pattern, finer, up to a fade-out of 1e-9.
    constexpr double spacing_m = 1.1e-3;
    double sum = 0.0;
    for (int i = -28; i <= 28; ++i)
        for (int j = -28; j <= 28; ++j) {
            const Vec2 off = {i * spacing_m, j * spacing_m};
            sum += slow_twin(array, focus, focus + off) * fading(array.reach_m, norm(off));
        }
    const double zero = 0.0;
    CHECK(force_areas_m2(load_of(array, at(focus)), {&zero, 1}).front() ==
          Approx(sum * spacing_m * spacing_m).epsilon(1e-8)); // both sums are spectrally accurate
}

TEST_CASE("several foci share the power of one", "[array]") {
    const bool is_array = GENERATE(true, false);
    const Footprint footprint = is_array ? Footprint(board()) : GaussianFootprint{0.01};
    Load one = load_of(footprint, at({})), two = one;
    two.modulation.foci_m = {{-0.02, 0.0}, {0.02, 0.0}};
    // An array steers both beams a little and they interfere in their side lobes.
    CHECK(first_force_N(two) == Approx(first_force_N(one)).epsilon(is_array ? 0.1 : 1e-12));
    if (!is_array) return;
    const std::vector<Vec2> places = foci(two.modulation, 0.0);
    const Patch patch = ArrayField(board(), 0.03).pattern({}, places);
    CHECK(*std::max_element(patch.values.begin(), patch.values.end()) == Approx(0.5).epsilon(0.15));
}

TEST_CASE("foci of Gaussian shape add as they stand", "[array]") {
    Load load = load_of(GaussianFootprint{0.003}, at({0.001, 0.0}));
    load.modulation.foci_m = {{-0.02, 0.0}, {0.0, 0.01}, {0.02, 0.0}};
    LoadPattern pattern(load, 1.0);
    CHECK_FALSE(pattern.changes());
    CHECK(pattern.origin_m() == Vec2{0.001, 0.0});
    const double kx = 321.0, ky = -123.0;
    Complex found, expected = 0.0;
    pattern.spectra(ky, {&kx, 1}, {&found, 1});
    for (const Vec2& d : load.modulation.foci_m)
        expected += std::polar(1.0 / 3.0, -(kx * d.x + ky * d.y));
    expected *= spectrum(load.footprint, kx, ky);
    CHECK(std::abs(found - expected) < 1e-14 * spectrum(load.footprint, 0.0, 0.0));
}

TEST_CASE("the pattern of an array without steering is the one below its centre, which moves",
          "[array]") {
    const Load load = load_of(board(), {{Travel{{{-0.01, 0.0}, {0.03, 0.0}}, ConstantSpeed{7.0}}}});
    LoadPattern moved = unsteered_pattern(load),
                centred(load_of(board(), at(board().center_m)), 0.0);
    CHECK_FALSE(moved.changes());
    const Vec2 first = moved.origin_m() - Vec2{-0.01, 0.0};
    moved.set(2e-3);
    CHECK(norm(moved.origin_m() - Vec2{0.004, 0.0} - first) < 1e-15);
    CHECK(norm(first - (centred.origin_m() - board().center_m)) < 1e-15);
    const double kx = 321.0, ky = -123.0;
    Complex found, expected;
    moved.spectra(ky, {&kx, 1}, {&found, 1});
    centred.spectra(ky, {&kx, 1}, {&expected, 1});
    CHECK(std::abs(found - expected) < 1e-14 * std::abs(expected));
}

TEST_CASE("the focus of an array follows a list of places at which it rests", "[array]") {
    const Polyline places({{}, {0.02, 0.0}, {0.02, 0.01}}, Ends::open);
    const Trajectory jumps = {{Travel{
        .path = places,
        .motion = Rests{.arcs_m = {0.0, 0.02, 0.03}, .ends_s = {1e-6, 2e-6, 1.0}, .levels = {}}}}};
    LoadPattern pattern(load_of(board(), jumps), 1.0);
    REQUIRE(pattern.changes());
    for (const auto& [t_s, place_m] :
         {std::pair(0.5e-6, Vec2{}), std::pair(1.5e-6, Vec2{0.02, 0.0}),
          std::pair(0.5, Vec2{0.02, 0.01})}) {
        pattern.set(t_s);
        LoadPattern resting(load_of(board(), at(place_m)), 1.0);
        // The same sums: both patterns lie on the lattice of the pistons.
        CHECK(pattern.origin_m().x == Approx(resting.origin_m().x).margin(1e-12));
        CHECK(pattern.origin_m().y == Approx(resting.origin_m().y).margin(1e-12));
    }
}

TEST_CASE("an array sets its focus at its update rate", "[array]") {
    ArrayFootprint array = board();
    array.update_rate_Hz = 16e3;
    const Load load = load_of(array, {{Travel{{{-0.01, 0.0}, {0.01, 0.0}}, ConstantSpeed{7.0}}}});
    const LoadPattern pattern(load, 0.002);
    CHECK(pattern.changes());
    CHECK(pattern.updated_s(0.0) == 0.0);
    CHECK(pattern.updated_s(62.4e-6) == 0.0);
    CHECK(pattern.updated_s(62.5e-6) == Approx(62.5e-6).epsilon(1e-12));
    CHECK(pattern.updated_s(1e-3 + 1e-6) == Approx(1e-3).epsilon(1e-12));
    CHECK(pattern.updated_s(0.5) == Approx(0.002).epsilon(1e-12)); // nobody looks later
}

} // namespace test_array_field
