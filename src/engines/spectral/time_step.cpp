#include "engines/spectral/time_step.hpp"

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/vertical_operator.hpp"
#include "model/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake {
namespace {

constexpr double shortest_step_s = 0.1e-6;
/// Estimates stay within about a factor of three of what is measured, above as below.
constexpr double safety = 2.0;

/// What moves and how fast, seen from the surface.
struct Scales {
    double k_rad_m; // where the footprint's spectrum has fallen to a half
    double wave_speed_m_s;
    double speed_m_s;   // of waves, or of the focus if that is faster
    double omega_rad_s; // of what the load excites
    double loss_1;      // omega viscosity / mu
};

/// Share of e^{-2 k z} between two depths: how much the surface sees of them.
double share(double k_rad_m, double top_m, double bottom_m) {
    return std::exp(-2.0 * k_rad_m * std::max(top_m, 0.0)) - std::exp(-2.0 * k_rad_m * bottom_m);
}

/// A stiff film on what is softer bends with it: its shear counts for little.
double film_factor(const Medium& medium, std::size_t layer, double k_rad_m) {
    if (layer > 0 || medium.layers.size() < 2) return 1.0;
    const Layer &film = medium.layers[0], &below = medium.layers[1];
    if (static_shear_modulus(film) < 4.0 * static_shear_modulus(below)) return 1.0;
    return std::min(1.0, std::pow(k_rad_m * film.thickness_m, 2));
}

double carrier_Hz(const Carrier& carrier) {
    const auto* resolved = std::get_if<ResolvedCarrier>(&carrier);
    return resolved ? resolved->frequency_Hz : 0.0;
}

Scales scales_of(const Case& c) {
    Scales s{.k_rad_m = bandwidth_rad_m(c.load.footprint, 0.5)};
    Material mean{};
    double top_m = 0.0;
    for (std::size_t l = 0; l < c.medium.layers.size(); ++l) {
        const Layer& layer = c.medium.layers[l];
        const bool endless = l + 1 == c.medium.layers.size() && c.medium.base == Base::half_space;
        const double bottom_m =
            endless ? std::numeric_limits<double>::infinity() : top_m + layer.thickness_m;
        const double weight =
            film_factor(c.medium, l, s.k_rad_m) * share(s.k_rad_m, top_m, bottom_m);
        const Material m = material_of(layer);
        mean.density_kg_m3 += weight * m.density_kg_m3;
        mean.mu_Pa += weight * m.mu_Pa;
        mean.viscosity_Pa_s += weight * m.viscosity_Pa_s;
        top_m = bottom_m;
    }
    s.wave_speed_m_s = std::sqrt(mean.mu_Pa / mean.density_kg_m3);
    s.speed_m_s = std::max(s.wave_speed_m_s, greatest_speed_m_s(c.load.modulation.trajectory));
    s.omega_rad_s =
        s.k_rad_m * s.speed_m_s + 2.0 * std::numbers::pi *
                                      (greatest_envelope_frequency_Hz(c.load.modulation.envelope) +
                                       carrier_Hz(c.load.carrier));
    s.loss_1 = mean.viscosity_Pa_s * s.omega_rad_s / mean.mu_Pa;
    return s;
}

/// Inertia that stabilisation adds to a place of some stiffness, relative to its own.
double added_inertia(const VerticalOperator& vertical, std::size_t element, const Material& m,
                     double k_rad_m, double least_speed_m_s, double step_s) {
    const double stabilised = vertical.stabilised_mu_Pa(element, m.mu_Pa, k_rad_m, step_s);
    const double excess = stabilised / m.mu_Pa - 1.0 / 12.0;
    const double speed_m_s = std::max(std::sqrt(m.mu_Pa / m.density_kg_m3), least_speed_m_s);
    return excess * std::pow(k_rad_m * speed_m_s * step_s, 2);
}

/// What stiff bodies add, as far as the surface sees them.
double inertia_of_bodies(const Case& c, const SpectralOptions& options, const DepthMesh& mesh,
                         const VerticalOperator& vertical, const Scales& s, double step_s) {
    double most = 0.0;
    for (const Body& body : c.medium.bodies) {
        const Bounds box = bounds(body);
        for (std::size_t e = 0; e < mesh.elements(); ++e) {
            const double top_m = std::max(box.low_m.z, mesh.ends_m[e]);
            if (!body.c_s_m_s || top_m >= std::min(box.high_m.z, mesh.ends_m[e + 1])) continue;
            Layer layer = c.medium.layers[mesh.layers[e]];
            const double most_mu_Pa = options.contrast_cap * static_shear_modulus(layer);
            layer.c_s_m_s = *body.c_s_m_s;
            layer.density_kg_m3 = body.density_kg_m3.value_or(layer.density_kg_m3);
            Material m = material_of(layer);
            m.mu_Pa = std::min(m.mu_Pa, most_mu_Pa);
            const double y = added_inertia(vertical, e, m, s.k_rad_m, s.speed_m_s, step_s);
            // What is rigid already does not become more so.
            most = std::max(most, std::exp(-2.0 * s.k_rad_m * top_m) * y / (1.0 + y));
        }
    }
    return most;
}

/// The error that a step leaves in the surface field, relative L2. With x = omega dt: terms of
/// fourth order (of waves that run free, of what is driven) and what stabilisation adds, which
/// shift phases the longer the run the more, until losses end the short waves that carry most of
/// it; and the second order of viscous forces. The weights are measured against engine `layered`
/// (footprints of 2 to 10 mm, 0 to 9 m/s, 0 to 5 Pa s, c_s 2 to 10 m/s, steps of 12.5 to 100 us,
/// runs of 4 ms).
double expected_error(const Case& c, const SpectralOptions& options, const Scales& s,
                      double step_s) {
    const DepthMesh mesh = choose_mesh(c, options, step_s);
    const VerticalOperator vertical(mesh, background_of(mesh, c.medium));
    double inertia = 0.0;
    for (std::size_t e = 0; e < mesh.elements(); ++e)
        inertia += film_factor(c.medium, mesh.layers[e], s.k_rad_m) *
                   share(s.k_rad_m, mesh.ends_m[e], mesh.ends_m[e + 1]) *
                   added_inertia(vertical, e, material_of(c.medium.layers[mesh.layers[e]]),
                                 s.k_rad_m, s.speed_m_s, step_s);
    inertia += inertia_of_bodies(c, options, mesh, vertical, s, step_s);
    const double x2 = std::pow(s.omega_rad_s * step_s, 2);
    const double free4 = std::pow(s.k_rad_m * s.wave_speed_m_s * step_s, 4);
    const double longer = std::max(1.0, s.omega_rad_s * c.time.duration_s() / 10.0);
    return 0.8 * free4 / (1.0 / longer + 10.0 * s.loss_1) +
           (0.1 * x2 * x2 + 0.8 * inertia) / (1.0 / longer + 4.0 * s.loss_1) +
           0.044 * s.loss_1 * x2 / (1.0 + 4.0 * s.loss_1);
}

TimeStep divided(const Case& c, std::ptrdiff_t per_frame) {
    return {c.time.interval_s / static_cast<double>(per_frame), per_frame, ""};
}

} // namespace

TimeStep choose_time_step(const Case& c, const SpectralOptions& options) {
    if (options.time_step_s) {
        const double ratio = c.time.interval_s / *options.time_step_s;
        TimeStep given = divided(
            c, std::max<std::ptrdiff_t>(1, static_cast<std::ptrdiff_t>(std::ceil(ratio - 1e-9))));
        given.why = fmt::format("time step {:.4g} us, as the job gives it", 1e6 * given.step_s);
        return given;
    }
    const Scales s = scales_of(c);
    TimeStep chosen = divided(c, 1);
    double error = expected_error(c, options, s, chosen.step_s);
    while (safety * error > options.accuracy && chosen.step_s > shortest_step_s) {
        chosen = divided(c, chosen.per_frame + std::max<std::ptrdiff_t>(1, chosen.per_frame / 16));
        error = expected_error(c, options, s, chosen.step_s);
    }
    chosen.why =
        fmt::format("time step {:.4g} us for an accuracy of {:.2g}: waves of {:.3g} mm at {:.3g} "
                    "m/s are {:.3g} "
                    "Hz, {:.2g} expected",
                    1e6 * chosen.step_s, options.accuracy, 2e3 * std::numbers::pi / s.k_rad_m,
                    s.speed_m_s, s.omega_rad_s / (2.0 * std::numbers::pi), error);
    return chosen;
}

} // namespace shearwake
