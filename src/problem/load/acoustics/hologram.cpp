// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/acoustics/hologram.hpp"

#include "base/units.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {

namespace {

using Complex = std::complex<double>;

/// x / |x|; 1 for 0.
Complex direction(Complex x) {
    const double modulus = std::abs(x);
    return modulus > 0.0 ? x / modulus : Complex(1.0);
}

/// The phases of the sources if focus m is a point source of the complex strength `strengths[m]`.
std::vector<Complex> phases(const Transfers& transfers, std::span<const Complex> strengths) {
    std::vector<Complex> drives(transfers.sources);
    for (std::size_t m = 0; m < strengths.size(); ++m) {
        const auto of_focus = transfers.focus(m);
        for (std::size_t n = 0; n < drives.size(); ++n)
            drives[n] += std::conj(of_focus[n]) * strengths[m];
    }
    for (Complex& drive : drives)
        drive = direction(drive);
    return drives;
}

} // namespace

std::vector<Complex> pressures_at_foci(const Transfers& transfers,
                                       std::span<const Complex> drives) {
    std::vector<Complex> pressures;
    for (std::size_t m = 0; m < transfers.foci(); ++m) {
        Complex sum = 0.0;
        const auto of_focus = transfers.focus(m);
        for (std::size_t n = 0; n < of_focus.size(); ++n)
            sum += of_focus[n] * drives[n];
        pressures.push_back(sum);
    }
    return pressures;
}

std::vector<Complex> superposed_drives(const Transfers& transfers) {
    std::vector<Complex> drives(transfers.sources);
    for (std::size_t m = 0; m < transfers.foci(); ++m) {
        const auto of_focus = transfers.focus(m);
        for (std::size_t n = 0; n < drives.size(); ++n)
            drives[n] += std::conj(of_focus[n]) / std::abs(of_focus[n]);
    }
    return drives;
}

std::vector<Complex> phased_drives(Hologram hologram, const Transfers& transfers, int iterations) {
    const std::size_t foci = transfers.foci();
    std::vector<Complex> strengths;
    for (std::size_t m = 0; m < foci; ++m) {
        const double turns = 0.5 * static_cast<double>(m * (m + 1)) / std::numbers::phi;
        strengths.push_back(std::polar(1.0, two_pi * turns));
    }
    std::vector<double> weights(foci, 1.0);
    std::vector<Complex> drives = phases(transfers, strengths);
    for (int iteration = 0; iteration < iterations; ++iteration) {
        const std::vector<Complex> pressures = pressures_at_foci(transfers, drives);
        double mean = 0.0;
        for (const Complex& p : pressures)
            mean += std::abs(p) / static_cast<double>(foci);
        for (std::size_t m = 0; m < foci; ++m) {
            const double modulus = std::abs(pressures[m]);
            if (hologram == Hologram::wgs && modulus > 0.0) weights[m] *= mean / modulus;
            strengths[m] = weights[m] * direction(pressures[m]);
        }
        drives = phases(transfers, strengths);
    }
    return drives;
}

double TargetImage::at(Vec2 at_m, double width_m) const {
    const double pixel_m = width_m / static_cast<double>(columns);
    const auto column = static_cast<std::ptrdiff_t>(
        std::floor(at_m.x / pixel_m + 0.5 * static_cast<double>(columns)));
    const auto row =
        static_cast<std::ptrdiff_t>(std::floor(0.5 * static_cast<double>(rows) - at_m.y / pixel_m));
    if (column < 0 || column >= columns || row < 0 || row >= rows) return 0.0;
    return greys[static_cast<std::size_t>(row * columns + column)];
}

bool is_inside(const std::vector<Vec2>& corners, Vec2 at) {
    bool inside = false;
    for (std::size_t i = 0, before = corners.size() - 1; i < corners.size(); before = i++) {
        const Vec2 a = corners[i], b = corners[before];
        if ((a.y > at.y) != (b.y > at.y) && at.x < a.x + (b.x - a.x) * (at.y - a.y) / (b.y - a.y))
            inside = !inside;
    }
    return inside;
}

} // namespace shearwake
