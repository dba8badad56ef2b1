// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/edges.hpp"

#include "base/units.hpp"
#include "problem/load/load_pattern.hpp"

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

/// The thickness above a rigid base, infinite on a half-space.
double depth_m(const Medium& medium) {
    if (medium.base == Base::half_space) return std::numeric_limits<double>::infinity();
    double sum_m = 0.0;
    for (const Layer& layer : medium.layers)
        sum_m += layer.thickness_m;
    return sum_m;
}

/// A mode e^{ikx} of the surface of a nearly incompressible layer as an oscillator: the mass is
/// that of the flow from rest, the stiffness the static one. Driven by the force of a point load.
struct Mode {
    double k_rad_m, mass_kg, stiffness_N_m, damping_N_s_m;
    double u_m = 0.0, v_m_s = 0.0, a_m_s2 = 0.0;

    double rate_rad_s() const { return std::sqrt(stiffness_N_m / mass_kg); }

    /// A step with constant mean acceleration (Newmark 1959), which is stable for any step.
    void advance(double dt_s, double force_N) {
        const double c = 2.0 / dt_s, m = mass_kg * c * c;
        const double push_N = force_N + m * u_m + mass_kg * (2.0 * c * v_m_s + a_m_s2) +
                              damping_N_s_m * (c * u_m + v_m_s);
        const double next_m = push_N / (stiffness_N_m + c * damping_N_s_m + m);
        const double next_m_s = c * (next_m - u_m) - v_m_s;
        a_m_s2 = c * c * (next_m - u_m) - 2.0 * c * v_m_s - a_m_s2;
        u_m = next_m;
        v_m_s = next_m_s;
    }
};

/// The mode of the wave number k per unit of area.
Mode mode_of(const Medium& medium, double k_rad_m, double penetration_m) {
    const double x = k_rad_m * depth_m(medium);
    const bool is_deep = !(x < 20.0); // the base changes the mode by e^-40
    const double flow = is_deep ? 1.0 : std::tanh(x), square = std::cosh(is_deep ? 0.0 : x);
    const double compliance =
        is_deep ? 1.0 : (std::sinh(x) * std::cosh(x) - x) / (square * square + x * x);
    const Layer& top = medium.layers.front();
    const double speed_m_s = edge_speed_m_s(medium, penetration_m);
    Mode mode{.k_rad_m = k_rad_m,
              .mass_kg = top.density_kg_m3 / (k_rad_m * flow),
              .stiffness_N_m =
                  2.0 * top.density_kg_m3 * speed_m_s * speed_m_s * k_rad_m / compliance,
              .damping_N_s_m = 0.0};
    const double rate_rad_s = mode.rate_rad_s();
    if (rate_rad_s > 0.0 && static_shear_modulus(top) > 0.0)
        mode.damping_N_s_m = mode.stiffness_N_m * shear_modulus(top, rate_rad_s).imag() /
                             (static_shear_modulus(top) * rate_rad_s);
    return mode;
}

} // namespace

std::vector<double> image_uplift_m(const Case& c) {
    const double width_m = c.domain.extent_x_m(), height_m = c.domain.extent_y_m();
    // The disc with the same integral of 1/r^3 outside of it as outside of the rectangle.
    const double radius_m =
        std::numbers::pi / 4.0 * width_m * height_m / std::hypot(width_m, height_m);
    const Medium& medium = c.scene.medium;
    const double dt_s = c.time.interval_s;
    const auto frames = static_cast<std::size_t>(c.time.frames);
    const double delay_s = std::min(width_m, height_m) / medium.layers.front().c_p_m_s;
    const double steps = std::ceil(delay_s / dt_s);
    std::vector<double> uplift_m(frames, 0.0);
    if (steps > static_cast<double>(frames)) return uplift_m;
    const auto delay = static_cast<std::size_t>(steps);
    Load averaged = c.scene.load;
    averaged.carrier = AveragedCarrier{};
    const double k_zero = 0.0;
    std::complex<double> area_m2;
    unsteered_pattern(averaged).spectra(0.0, {&k_zero, 1}, {&area_m2, 1});
    std::vector<double> force_N;
    for (std::size_t n = 0; n <= frames; ++n)
        force_N.push_back(area_m2.real() * averaged.peak_Pa *
                          strength(averaged, static_cast<double>(n) * dt_s));
    // Up to where the spectrum of a Gaussian of this width has fallen to e^-8.
    const double sigma_m = fwhm_m(c.scene.load.footprint) / std::sqrt(8.0 * std::numbers::ln2);
    const double step_rad_m = 0.1 / radius_m; // of the oscillating J1(k R)
    for (double k = 0.5 * step_rad_m; k * sigma_m < 4.0; k += step_rad_m) {
        Mode mode = mode_of(medium, k, radius_m);
        // k dk/(2 pi), the mean over the disc 2 J1(k R)/(k R), and the area of the disc per domain.
        const double share = step_rad_m * ::j1(k * radius_m) * radius_m *
                             std::exp(-0.5 * k * k * sigma_m * sigma_m) / (width_m * height_m);
        // The response to an impulse, from the moment at which P waves have crossed the domain.
        const double wait_s = static_cast<double>(delay) * dt_s;
        const double turned = mode.rate_rad_s() * wait_s;
        const double kick =
            (turned > 0.0 ? std::sin(turned) / turned : 1.0) * wait_s / mode.mass_kg;
        for (std::size_t m = 1; m + delay <= frames; ++m) {
            mode.advance(dt_s, std::cos(turned) * force_N[m]);
            mode.u_m += 0.5 * dt_s * (force_N[m - 1] + force_N[m]) * kick;
            uplift_m[m + delay - 1] += share * mode.u_m;
        }
    }
    return uplift_m;
}

} // namespace shearwake
