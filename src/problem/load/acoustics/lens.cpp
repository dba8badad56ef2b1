// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/lens.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>

namespace shearwake {
namespace {

/// Points per wavelength that represent |p|^2, whose wave numbers reach 2 k.
constexpr double points_a_wavelength = 4.0;
/// Points per distance from the skin, which also represent evanescent waves.
constexpr double points_a_distance = 2.0;
constexpr double air_impedance_density_kg_m3 = 1.184; // air of 25 degrees

/// The smallest product of 3, 5 and 7 that is at least n. Such products are too rare among large
/// numbers to be searched; lattices of that size are rejected.
std::ptrdiff_t good_odd_length(std::ptrdiff_t n) {
    constexpr std::ptrdiff_t most = 1000000;
    for (; n < most; ++n) {
        std::ptrdiff_t rest = n;
        for (const std::ptrdiff_t factor : {3, 5, 7})
            while (rest % factor == 0)
                rest /= factor;
        if (rest == 1) return n;
    }
    return n;
}

} // namespace

bool LensFootprint::operator==(const LensFootprint& other) const {
    const auto numbers = [](const LensFootprint& lens) {
        return std::tie(lens.aperture_m, lens.distance_m, lens.frequency_Hz, lens.sound_speed_m_s,
                        lens.absorption_dB_m, lens.pixel_m, lens.phase_levels, lens.iterations,
                        lens.material_c_m_s, lens.material_density_kg_m3, lens.base_m, lens.foci_m,
                        lens.polygon_m, lens.image_width_m, lens.reach_m);
    };
    const auto picture = [](const LensFootprint& lens) {
        return lens.image ? lens.image->content_hash : std::string();
    };
    return numbers(*this) == numbers(other) && picture(*this) == picture(other);
}

double wavelength_m(const LensFootprint& lens) {
    return lens.sound_speed_m_s / lens.frequency_Hz;
}

double focal_width_m(const LensFootprint& lens) {
    const double radius_m = 0.5 * lens.aperture_m;
    return 0.51 * wavelength_m(lens) * std::hypot(radius_m, lens.distance_m) / radius_m;
}

double target_extent_m(const LensFootprint& lens) {
    double extent_m = 0.0;
    for (const auto* points : {&lens.foci_m, &lens.polygon_m})
        for (const Vec2& at : *points)
            extent_m = std::max(extent_m, norm(at));
    if (lens.image)
        extent_m = 0.5 * lens.image_width_m *
                   std::hypot(1.0, static_cast<double>(lens.image->rows) /
                                       static_cast<double>(lens.image->columns));
    return extent_m;
}

double target_pressure(const LensFootprint& lens, Vec2 at_m) {
    if (lens.image) return lens.image->at(at_m, lens.image_width_m);
    if (!lens.polygon_m.empty()) return is_inside(lens.polygon_m, at_m) ? 1.0 : 0.0;
    const double decay = 4.0 * std::numbers::ln2 / std::pow(focal_width_m(lens), 2);
    double pressure = 0.0;
    for (const Vec2& focus : lens.foci_m) {
        const double r = norm(at_m - focus);
        pressure = std::max(pressure, std::exp(-decay * r * r));
    }
    return pressure;
}

LensLattice lattice(const LensFootprint& lens) {
    LensLattice lattice;
    const double spacing_m =
        std::min(wavelength_m(lens) / points_a_wavelength, lens.distance_m / points_a_distance);
    lattice.points_per_pixel = std::max<std::ptrdiff_t>(
        1, static_cast<std::ptrdiff_t>(std::ceil(lens.pixel_m / spacing_m - 1e-9)));
    lattice.spacing_m = lens.pixel_m / static_cast<double>(lattice.points_per_pixel);
    // Offsets between the lens and the pattern are at most half a side, with a margin for pixels
    // and points on their edges.
    const double offset_m = 0.5 * lens.aperture_m + fading_end_m(lens.reach_m) + 1.5 * lens.pixel_m;
    const double pixels = std::ceil(2.0 * offset_m / lens.pixel_m);
    lattice.side = lattice.points_per_pixel *
                   good_odd_length(static_cast<std::ptrdiff_t>(std::min(pixels, 1e9)));
    return lattice;
}

std::ptrdiff_t pixels_along(const LensFootprint& lens) {
    const LensLattice grid = lattice(lens);
    const std::ptrdiff_t all = grid.side / grid.points_per_pixel;
    const auto half =
        static_cast<std::ptrdiff_t>(std::ceil(0.5 * lens.aperture_m / lens.pixel_m + 0.5));
    return all - 2 * std::max<std::ptrdiff_t>(0, all / 2 - half);
}

double thickness_m(const LensFootprint& lens, double phase_rad) {
    // The phase of the transmitted sound is (k_lens - k_air) thickness.
    const double k_air = two_pi * lens.frequency_Hz / lens.sound_speed_m_s;
    const double k_lens = two_pi * lens.frequency_Hz / lens.material_c_m_s;
    const double phase = k_lens > k_air ? phase_rad : two_pi - phase_rad;
    const double turns = phase / two_pi;
    return lens.base_m + two_pi * (turns - std::floor(turns)) / std::abs(k_lens - k_air);
}

double transmission(const LensFootprint& lens, double thickness_m) {
    const double ratio = lens.material_density_kg_m3 * lens.material_c_m_s /
                         (air_impedance_density_kg_m3 * lens.sound_speed_m_s);
    const double mismatch = 0.5 * (ratio - 1.0 / ratio);
    const double s = std::sin(two_pi * lens.frequency_Hz / lens.material_c_m_s * thickness_m);
    return 1.0 / (1.0 + mismatch * mismatch * s * s);
}

} // namespace shearwake
