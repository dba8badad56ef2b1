// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/array_field.hpp"

#include "base/error.hpp"
#include "base/units.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
/// Minimum number of samples per wavelength. |p|^2 has no wave number above 2 k sin(angle to the
/// outermost piston), about 1000 rad/m here; the lattice represents 6.5 k / 2 = 2400 rad/m.
constexpr double samples_a_wavelength = 6.5;
/// Iterations of a hologram, after which 100 weighted foci are equal within 1 %.
constexpr int iterations = 60;

double wave_number_rad_m(const ArrayFootprint& array) {
    return two_pi * array.frequency_Hz / array.sound_speed_m_s;
}

/// Calls f(column, row) for each existing piston.
template <class F>
void for_pistons(const ArrayFootprint& array, F f) {
    for (std::ptrdiff_t row = 0; row < array.rows; ++row)
        for (std::ptrdiff_t column = 0; column < array.columns; ++column)
            if (!std::binary_search(array.missing.begin(), array.missing.end(),
                                    column + row * array.columns))
                f(column, row);
}

/// The position of a piston relative to the centre of the array.
Vec2 place_m(const ArrayFootprint& array, std::ptrdiff_t column, std::ptrdiff_t row) {
    return {(static_cast<double>(column) - 0.5 * static_cast<double>(array.columns - 1)) *
                array.pitch_m,
            (static_cast<double>(row) - 0.5 * static_cast<double>(array.rows - 1)) * array.pitch_m};
}

/// |p| directly below the centre when all pistons are in phase there [1/m].
double amplitude_below(const ArrayFootprint& array) {
    double sum = 0.0;
    for_pistons(array, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        const Complex p = piston_pressure(array, norm(place_m(array, column, row)));
        sum += std::abs(p); // independent of the sign of D, which the drive compensates
    });
    return sum;
}

} // namespace

Complex piston_pressure(const ArrayFootprint& array, double offset_m) {
    const double k = wave_number_rad_m(array), r = std::hypot(offset_m, array.distance_m);
    const double x = k * array.radius_m * offset_m / r;
    const double directivity = x > 1e-6 ? 2.0 * ::j1(x) / x : 1.0 - x * x / 8.0;
    return std::polar(directivity / r, k * r);
}

PressureBelow::PressureBelow(const ArrayFootprint& array)
    : array_(array), amplitude_(amplitude_below(array)) {
    for_pistons(array, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        const Complex there = piston_pressure(array, norm(place_m(array, column, row)));
        drives_.push_back(std::conj(there) / std::abs(there));
    });
}

double PressureBelow::operator()(double x_m, double y_m) const {
    Complex sum = 0.0;
    std::size_t piston = 0;
    for_pistons(array_, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        sum += drives_[piston++] *
               piston_pressure(array_, norm(Vec2{x_m, y_m} - place_m(array_, column, row)));
    });
    return std::norm(sum / amplitude_);
}

double pressure_below(const ArrayFootprint& array, double x_m, double y_m) {
    return PressureBelow(array)(x_m, y_m);
}

double peak_Pa(const ArrayFootprint& array, double strength_Pa_m, double air_density_kg_m3) {
    const double amplitude_Pa = strength_Pa_m * amplitude_below(array);
    return amplitude_Pa * amplitude_Pa /
           (air_density_kg_m3 * array.sound_speed_m_s * array.sound_speed_m_s);
}

ArrayField::ArrayField(const ArrayFootprint& array, double furthest_m) : array_(array) {
    const double wavelength_m = two_pi / wave_number_rad_m(array);
    per_pitch_ = static_cast<std::ptrdiff_t>(
        std::ceil(samples_a_wavelength * array.pitch_m / wavelength_m - 1e-9));
    spacing_m_ = array.pitch_m / static_cast<double>(per_pitch_);
    reach_ = static_cast<std::ptrdiff_t>(std::ceil(fading_end_m(array.reach_m) / spacing_m_));
    peak_ = amplitude_below(array);
    const std::ptrdiff_t longest = std::max(array.columns, array.rows) * per_pitch_;
    half_ =
        longest / 2 + reach_ + 2 + static_cast<std::ptrdiff_t>(std::ceil(furthest_m / spacing_m_));
    const std::ptrdiff_t width = 2 * half_ + 1;
    re_.resize(static_cast<std::size_t>((half_ + 1) * width));
    im_.resize(re_.size());
    const auto put = [&](std::ptrdiff_t i, std::ptrdiff_t j, Complex p) {
        for (const std::ptrdiff_t column : {half_ - j, half_ + j}) {
            re_[static_cast<std::size_t>(i * width + column)] = p.real();
            im_[static_cast<std::size_t>(i * width + column)] = p.imag();
        }
    };
    for (std::ptrdiff_t i = 0; i <= half_; ++i)
        for (std::ptrdiff_t j = 0; j <= i; ++j) {
            const double offset_m =
                spacing_m_ * std::hypot(static_cast<double>(i), static_cast<double>(j));
            const Complex p = piston_pressure(array, offset_m);
            put(i, j, p);
            put(j, i, p);
        }
}

const double* ArrayField::table_row(const std::vector<double>& table, std::ptrdiff_t offset) const {
    return table.data() + std::abs(offset) * (2 * half_ + 1) + half_;
}

BoardOrder board_order(const ArrayFootprint& array) {
    BoardOrder order;
    for_pistons(array, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        order.emplace(std::pair(column, -row), order.size());
    });
    return order;
}

/// Drives that focus on all foci, with the total power of a single focus.
std::vector<Complex> ArrayField::drives(std::span<const Vec2> foci_m) const {
    const auto distance_m = [&](const PhaseFrame& f) { return norm(f.place_m - foci_m.front()); };
    if (array_.frames) return std::ranges::min_element(array_.frames->all, {}, distance_m)->drives;
    Transfers transfers;
    for (const Vec2& focus : foci_m)
        for_pistons(array_, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
            const Vec2 place = array_.center_m + place_m(array_, column, row);
            transfers.values.push_back(piston_pressure(array_, norm(focus - place)));
        });
    transfers.sources = transfers.values.size() / foci_m.size();
    std::vector<Complex> drives = array_.hologram == Hologram::superposition
                                      ? superposed_drives(transfers)
                                      : phased_drives(array_.hologram, transfers, iterations);
    double power = 0.0;
    for (Complex& drive : drives) {
        if (array_.phase_levels > 0) {
            const double step = two_pi / array_.phase_levels;
            drive = std::polar(std::abs(drive), step * std::round(std::arg(drive) / step));
        }
        power += std::norm(drive);
    }
    const double scale = power > 0.0 ? std::sqrt(static_cast<double>(drives.size()) / power) : 0.0;
    for (Complex& drive : drives)
        drive *= scale;
    return drives;
}

Patch ArrayField::pattern(Vec2 middle_m, std::span<const Vec2> foci_m) const {
    // Lattice indices are relative to the first piston.
    const Vec2 first_m = array_.center_m + place_m(array_, 0, 0);
    const auto index = [&](double m) {
        return static_cast<std::ptrdiff_t>(std::llround(m / spacing_m_));
    };
    const std::ptrdiff_t i0 = index(middle_m.x - first_m.x) - reach_,
                         j0 = index(middle_m.y - first_m.y) - reach_;
    const std::ptrdiff_t last_x = (array_.columns - 1) * per_pitch_,
                         last_y = (array_.rows - 1) * per_pitch_;
    if (std::min({i0 - last_x, j0 - last_y}) < -half_ || std::max(i0, j0) + 2 * reach_ > half_)
        throw Error("the pattern of an array was requested outside its table");
    Patch patch;
    patch.side = 2 * reach_ + 1;
    patch.spacing_m = spacing_m_;
    patch.origin_m =
        first_m + Vec2{static_cast<double>(i0) * spacing_m_, static_cast<double>(j0) * spacing_m_};
    const auto samples = static_cast<std::size_t>(patch.side * patch.side);
    std::vector<double> re(samples), im(samples);
    const std::vector<Complex> q = drives(foci_m);
    struct Shift {
        std::ptrdiff_t i, j;
    };
    std::vector<Shift> shifts; // of the pistons
    for_pistons(array_, [&](std::ptrdiff_t column, std::ptrdiff_t row) {
        shifts.push_back({i0 - column * per_pitch_, j0 - row * per_pitch_});
    });
    // The sums of a row stay in the cache.
    for (std::ptrdiff_t i = 0; i < patch.side; ++i) {
        double* to_re = re.data() + i * patch.side;
        double* to_im = im.data() + i * patch.side;
        for (std::size_t piston = 0; piston < q.size(); ++piston) {
            const double a = q[piston].real(), b = q[piston].imag();
            const auto [shift_i, shift_j] = shifts[piston];
            const double* g = table_row(re_, shift_i + i) + shift_j;
            const double* h = table_row(im_, shift_i + i) + shift_j;
            for (std::ptrdiff_t j = 0; j < patch.side; ++j) {
                to_re[j] += a * g[j] - b * h[j];
                to_im[j] += a * h[j] + b * g[j];
            }
        }
    }
    patch.values.resize(samples);
    for (std::size_t n = 0; n < samples; ++n) {
        const auto i = static_cast<std::ptrdiff_t>(n) / patch.side,
                   j = static_cast<std::ptrdiff_t>(n) % patch.side;
        const Vec2 there = patch.origin_m + Vec2{static_cast<double>(i) * spacing_m_,
                                                 static_cast<double>(j) * spacing_m_};
        patch.values[n] = (re[n] * re[n] + im[n] * im[n]) / (peak_ * peak_) *
                          fading(array_.reach_m, norm(there - middle_m));
    }
    return patch;
}

} // namespace shearwake
