// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/edges.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>

namespace shearwake {

namespace {

constexpr double damping_scale = 7.3;

} // namespace

double edge_drag_Hz(double distance_m, double width_m, double speed_m_s) {
    const double inward = distance_m / width_m;
    if (!(inward < 1.0)) return 0.0;
    return damping_scale * speed_m_s / width_m * std::pow(1.0 - std::max(inward, 0.0), 1.5);
}

/// Solves u'' + (k^2 - i k gamma/c) u = 0 slice by slice from the far side, where u = e^{-ikx}.
double returned_energy(double wavelength_m, double width_m) {
    using Complex = std::complex<double>;
    constexpr Complex i(0.0, 1.0);
    constexpr int slices = 240;
    const double k = two_pi * width_m / wavelength_m, thickness = 2.0 / slices;
    Complex u = 1.0, slope = -i * k;
    for (int n = 0; n < slices; ++n) {
        const double from_edge = std::abs(1.0 - (n + 0.5) * thickness);
        const Complex q = std::sqrt(k * k - i * k * edge_drag_Hz(from_edge, 1.0, 1.0));
        const Complex c = std::cos(q * thickness), s = std::sin(q * thickness), was = u;
        u = c * was - s / q * slope;
        slope = q * s * was + c * slope;
    }
    const Complex in = 0.5 * (u + i * slope / k), back = 0.5 * (u - i * slope / k);
    return (std::norm(back) + 1.0) / std::norm(in);
}

double edge_speed_m_s(const Medium& medium, double depth_m) {
    double mass = 0.0, stiffness = 0.0, top_m = 0.0;
    for (std::size_t l = 0; l < medium.layers.size(); ++l) {
        const Layer& layer = medium.layers[l];
        const bool endless = medium.base == Base::half_space && l + 1 == medium.layers.size();
        const double bottom_m = endless ? depth_m : std::min(depth_m, top_m + layer.thickness_m);
        const double thickness_m = std::max(bottom_m - top_m, 0.0);
        mass += layer.density_kg_m3 * thickness_m;
        stiffness += static_shear_modulus(layer) * thickness_m;
        top_m += thickness_m;
    }
    return mass > 0.0 ? std::sqrt(stiffness / mass) : 0.0;
}

double longest_wave_m(const Load& load, double speed_m_s) {
    const double of_footprint_m = 3.0 * two_pi / bandwidth_rad_m(load.footprint, 0.5);
    const auto frequency_Hz = modulation_frequency_Hz(load.modulation);
    if (!frequency_Hz || !(*frequency_Hz > 0.0)) return of_footprint_m;
    return std::max(of_footprint_m, speed_m_s / *frequency_Hz);
}

namespace {

/// Mirror images decrease as n^-3 and alternate: the first term that is omitted bounds the rest.
constexpr int mirror_images = 50;

/// The thickness above a rigid base, infinite on a half-space.
double depth_m(const Medium& medium) {
    if (medium.base == Base::half_space) return std::numeric_limits<double>::infinity();
    double sum_m = 0.0;
    for (const Layer& layer : medium.layers)
        sum_m += layer.thickness_m;
    return sum_m;
}

/// integral of 1/r^3 from r = radius to infinity, times r, for the flow in a layer: 1/radius, and
/// the images of the load in the base and in the surface.
double integral_beyond(double radius_m, double thickness_m) {
    double sum = 1.0 / radius_m;
    if (std::isinf(thickness_m)) return sum;
    for (int n = 1; n <= mirror_images; ++n) {
        const double z_m = 2.0 * n * thickness_m;
        const double term =
            2.0 * radius_m * radius_m * std::pow(radius_m * radius_m + z_m * z_m, -1.5);
        sum += n % 2 ? -term : term;
    }
    return std::max(sum, 0.0);
}

} // namespace

std::vector<double> image_uplift_m(const Case& c) {
    const double width_m = c.domain.extent_x_m(), height_m = c.domain.extent_y_m();
    // The disc with the same integral of 1/r^3 outside of it as outside of the rectangle.
    const double radius_m =
        std::numbers::pi / 4.0 * width_m * height_m / std::hypot(width_m, height_m);
    const Layer& top = c.scene().medium.layers.front();
    const double per_moment = integral_beyond(radius_m, depth_m(c.scene().medium)) /
                              (top.density_kg_m3 * width_m * height_m);
    const double dt_s = c.time.interval_s;
    const auto frames = static_cast<std::size_t>(c.time.frames);
    const double steps = std::ceil(std::min(width_m, height_m) / (top.c_p_m_s * dt_s));
    if (steps > static_cast<double>(frames)) return std::vector<double>(frames, 0.0);
    const auto delay = static_cast<std::size_t>(steps);
    Load averaged = c.scene().load;
    averaged.carrier = AveragedCarrier{};
    // The first and the second integral of the force over time, by the trapezoidal rule.
    std::vector<double> once(frames + 1, 0.0), twice(frames + 1, 0.0), uplift_m(frames, 0.0);
    std::vector<double> times_s;
    for (std::size_t n = 0; n <= frames; ++n)
        times_s.push_back(static_cast<double>(n) * dt_s);
    const std::vector<double> force_N = forces_N(averaged, times_s);
    for (std::size_t n = 1; n <= frames; ++n) {
        once[n] = once[n - 1] + 0.5 * dt_s * (force_N[n - 1] + force_N[n]);
        twice[n] = twice[n - 1] + 0.5 * dt_s * (once[n - 1] + once[n]);
        if (n < delay) continue;
        const std::size_t m = n - delay;
        uplift_m[n - 1] = per_moment * (twice[m] + static_cast<double>(delay) * dt_s * once[m]);
    }
    return uplift_m;
}

} // namespace shearwake
