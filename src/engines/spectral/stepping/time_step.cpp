// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/time_step.hpp"

#include "base/units.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <optional>
#include <vector>

namespace shearwake::spectral {
namespace {

/// Lower limit of the step in radians of the fastest motion. An accuracy of 1e-4 needs about 0.1.
/// Only compressional waves at c_p = 50 m/s without losses need less, which no skin has.
constexpr double shortest_step_rad = 0.02;
/// The estimated error is 0.4 to 5 times the measured error of complete fields.
constexpr double safety = 2.0;

/// Length and time scales of the motion, as observed at the surface.
struct Scales {
    double k_rad_m;                // where the spectrum of the footprint has fallen to a half
    double wave_speed_m_s, loss_1; // loss: omega viscosity / mu
    double scan_speed_m_s;
    double load_rad_s;  // of the load: scan or modulation
    double omega_rad_s; // maximum of all
    std::string fastest;
};

/// Share of e^{-2 k z} between two depths: the sensitivity of the surface to this range.
double share(double k_rad_m, double top_m, double bottom_m) {
    return std::exp(-2.0 * k_rad_m * std::max(top_m, 0.0)) - std::exp(-2.0 * k_rad_m * bottom_m);
}

/// A stiff film on a softer material bends with it, so that its shear stiffness has little
/// influence.
double film_factor(const Medium& medium, std::size_t layer, double k_rad_m) {
    if (layer > 0 || medium.layers.size() < 2) return 1.0;
    const Layer &film = medium.layers[0], &below = medium.layers[1];
    if (static_shear_modulus(film) < 4.0 * static_shear_modulus(below)) return 1.0;
    return std::min(1.0, std::pow(k_rad_m * film.thickness_m, 2));
}

/// Determines the fastest motion that a step must resolve, and its description.
void find_fastest(const Load& load, Scales& s) {
    const double wavelength_mm = 2e3 * std::numbers::pi / s.k_rad_m;
    const double carrier_Hz = carrier_frequency_Hz(load.carrier);
    const double modulation_Hz =
        greatest_envelope_frequency_Hz(load.modulation.envelope) + carrier_Hz;
    const double modulation_rad_s = two_pi * modulation_Hz;
    const double scan_rad_s = s.k_rad_m * s.scan_speed_m_s;
    const double shear_rad_s = s.k_rad_m * s.wave_speed_m_s;
    s.load_rad_s = std::max(modulation_rad_s, scan_rad_s);
    s.omega_rad_s = std::max(shear_rad_s, s.load_rad_s);
    if (s.omega_rad_s == modulation_rad_s)
        s.fastest = fmt::format("limited by the {} ({:.3g} Hz)",
                                carrier_Hz > 0.0 ? "carrier" : "modulation", modulation_Hz);
    else
        s.fastest = fmt::format("limited by {} ({:.3g} mm at {:.3g} m/s, {:.3g} Hz)",
                                s.omega_rad_s == scan_rad_s ? "the scan" : "shear waves",
                                wavelength_mm, s.omega_rad_s / s.k_rad_m, s.omega_rad_s / two_pi);
}

Scales scales_of(const Case& c) {
    Scales s{.k_rad_m = bandwidth_rad_m(c.scene.load.footprint, 0.5)};
    Material mean{};
    double top_m = 0.0;
    for (std::size_t l = 0; l < c.scene.medium.layers.size(); ++l) {
        const Layer& layer = c.scene.medium.layers[l];
        const bool endless =
            l + 1 == c.scene.medium.layers.size() && c.scene.medium.base == Base::half_space;
        const double bottom_m =
            endless ? std::numeric_limits<double>::infinity() : top_m + layer.thickness_m;
        const double weight =
            film_factor(c.scene.medium, l, s.k_rad_m) * share(s.k_rad_m, top_m, bottom_m);
        const Material m = material_of(layer);
        mean.density_kg_m3 += weight * m.density_kg_m3;
        mean.mu_Pa += weight * m.mu_Pa;
        mean.viscosity_Pa_s += weight * m.viscosity_Pa_s;
        top_m = bottom_m;
    }
    s.wave_speed_m_s = std::sqrt(mean.mu_Pa / mean.density_kg_m3);
    s.scan_speed_m_s = greatest_speed_m_s(c.scene.load.modulation.trajectory);
    find_fastest(c.scene.load, s);
    s.loss_1 = mean.viscosity_Pa_s * s.omega_rad_s / mean.mu_Pa;
    return s;
}

/// Inertia that the stabilisation of a stiffness adds, relative to the material's own inertia.
double added_inertia(const VerticalOperator& vertical, std::size_t element, const Material& m,
                     double k_rad_m, double least_speed_m_s, double step_s) {
    const double stabilised = vertical.stabilised_mu_Pa(element, m.mu_Pa, k_rad_m, step_s);
    const double excess = stabilised / m.mu_Pa - 1.0 / 12.0;
    const double speed_m_s = std::max(std::sqrt(m.mu_Pa / m.density_kg_m3), least_speed_m_s);
    return excess * std::pow(k_rad_m * speed_m_s * step_s, 2);
}

/// The highest stiffness of a body or of the map.
struct Inclusion {
    double top_m, bottom_m, c_s_m_s;
    std::optional<double> density_kg_m3;
};

std::vector<Inclusion> inclusions_of(const Medium& medium) {
    std::vector<Inclusion> all;
    for (const Body& body : medium.bodies)
        if (body.c_s_m_s && !body.rigid)
            all.push_back(
                {bounds(body).low_m.z, bounds(body).high_m.z, *body.c_s_m_s, body.density_kg_m3});
    if (medium.map && !medium.map->c_s_m_s.empty()) {
        const std::vector<double>& c_s_m_s = medium.map->c_s_m_s;
        const DepthRange range = depths(*medium.map);
        all.push_back({range.top_m, range.bottom_m, *std::ranges::max_element(c_s_m_s), {}});
    }
    return all;
}

/// Inertia that stiff bodies and the map add, weighted with the sensitivity of the surface.
double inertia_of_inclusions(const Case& c, const SpectralOptions& options, const DepthMesh& mesh,
                             const VerticalOperator& vertical, const Scales& s, double step_s) {
    double most = 0.0;
    for (const Inclusion& stiff : inclusions_of(c.scene.medium)) {
        for (std::size_t e = 0; e < mesh.elements(); ++e) {
            const double top_m = std::max(stiff.top_m, mesh.ends_m[e]);
            if (top_m >= std::min(stiff.bottom_m, mesh.ends_m[e + 1])) continue;
            Layer layer = c.scene.medium.layers[mesh.layers[e]];
            const double most_mu_Pa = options.contrast_cap * static_shear_modulus(layer);
            layer.c_s_m_s = stiff.c_s_m_s;
            layer.density_kg_m3 = stiff.density_kg_m3.value_or(layer.density_kg_m3);
            Material m = material_of(layer);
            m.mu_Pa = std::min(m.mu_Pa, most_mu_Pa);
            const double y = added_inertia(vertical, e, m, s.k_rad_m, s.scan_speed_m_s, step_s);
            // The response of a rigid inclusion saturates.
            most = std::max(most, std::exp(-2.0 * s.k_rad_m * top_m) * y / (1.0 + y));
        }
    }
    return most;
}

/// Estimated relative L2 error of the surface field caused by the time step.
struct Expected {
    double layers, bodies;
    double total() const { return layers + bodies; }
};

/// Factors of 1000 elements of degree 8 take 130 MB, and their first step 0.1 s.
constexpr double most_squares = 1000.0 * 8.0 * 8.0;

Expected expected_error(const Case& c, const SpectralOptions& options, const Scales& s,
                        double step_s, const engines::ChoiceLimit& limit) {
    const DepthMesh mesh = choose_mesh(c, options, step_s);
    if (limit.is_finite() &&
        static_cast<double>(mesh.elements()) * mesh.degree * mesh.degree > most_squares)
        throw engines::StepNotChosen{};
    const VerticalOperator vertical(mesh, background_of(mesh, c.scene.medium));
    const double periods = std::max(1.0, s.omega_rad_s * c.time.duration_s() / 10.0);
    return {probed_error(c, mesh, step_s, limit),
            0.8 * inertia_of_inclusions(c, options, mesh, vertical, s, step_s) /
                (1.0 / periods + 4.0 * s.loss_1)};
}

TimeStep divided(const Case& c, std::ptrdiff_t per_frame) {
    return {c.time.interval_s / static_cast<double>(per_frame), per_frame, ""};
}

} // namespace

TimeStep choose_time_step(const Case& c, const SpectralOptions& options,
                          engines::ChoiceLimit limit) {
    if (options.time_step_s) {
        const double ratio = c.time.interval_s / *options.time_step_s;
        TimeStep given = divided(
            c, std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9))));
        given.why = fmt::format("time step {:.4g} us, as specified in the job", 1e6 * given.step_s);
        return given;
    }
    const Scales s = scales_of(c);
    // Steps longer than a radian of the load would not resolve it at all, so that comparing two of
    // them would not show an error.
    const double least = std::max(1.0, std::ceil(c.time.interval_s * s.load_rad_s));
    TimeStep chosen = divided(c, static_cast<std::ptrdiff_t>(least));
    Expected error = expected_error(c, options, s, chosen.step_s, limit);
    const auto is_enough = [&] { return safety * error.total() <= options.accuracy; };
    while (!is_enough() && s.omega_rad_s * chosen.step_s > shortest_step_rad) {
        const double finer = std::pow(safety * error.total() / options.accuracy, 0.25);
        const double next =
            std::ceil(0.9 * static_cast<double>(chosen.per_frame) * std::min(finer, 2.0));
        chosen = divided(c, std::max(chosen.per_frame + 1, static_cast<std::ptrdiff_t>(next)));
        error = expected_error(c, options, s, chosen.step_s, limit);
    }
    chosen.why =
        fmt::format("time step {:.4g} us for an accuracy of {:.2g} (estimated error {:.1g}): {}",
                    1e6 * chosen.step_s, options.accuracy, error.total(),
                    !is_enough() ? "the accuracy is not reached, shorter steps are not considered"
                    : error.bodies > error.layers ? "limited by the stiffest inclusion"
                    : chosen.per_frame == 1       ? "one step per frame is sufficient"
                                                  : s.fastest);
    return chosen;
}

DepthMesh choose_mesh(const Case& c, const SpectralOptions& options) {
    return choose_mesh(c, options, choose_time_step(c, options).step_s);
}

} // namespace shearwake::spectral
