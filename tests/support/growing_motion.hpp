// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/vertical_operator.hpp"
#include "support/spectral_cases.hpp"

#include <cmath>

// A rigid body of 3 mm radius in a solid, evaluated at real exponential growth e^{st} instead of
// e^{i omega t}, where the engine's implicit operator is that of a viscoelastic medium.
namespace shearwake::test {

constexpr double body_radius_m = 3e-3, solid_kg_m3 = 1000.0, solid_mu_Pa = 25e3;
/// Ratio of lambda to mu of a practically incompressible solid.
constexpr double incompressible = 1e5;

/// A body in the middle of lossless tissue of this depth in radii.
inline Case solid_around(Body body, double depth, const Domain& domain,
                         const SpectralOptions& options) {
    Case c = focus_over_rigid_base(0.0, {depth * body_radius_m}, 0.0);
    body.centre_m.z = 0.5 * depth * body_radius_m;
    c.scene.medium.bodies = {std::move(body)};
    c.domain = domain;
    c.solver = options;
    return c;
}

/// M s^2 + K for kappa = s radius/c_s, as the implicit operator of a step of 1 s with the weights
/// .26 and 1/12.
inline spectral::Background growing_background(const spectral::DepthMesh& mesh,
                                               const Medium& medium, double kappa,
                                               double lambda_per_mu = incompressible) {
    spectral::Background b = spectral::background_of(mesh, medium);
    const double growth_1_s2 = std::pow(kappa / body_radius_m, 2) * solid_mu_Pa / solid_kg_m3;
    for (std::size_t i = 0; i < b.density_kg_m3.size(); ++i) {
        b.density_kg_m3[i] = solid_kg_m3 * growth_1_s2;
        b.lambda_Pa[i] = lambda_per_mu * solid_mu_Pa / 0.26;
        b.mu_accurate_Pa[i] = 12.0 * solid_mu_Pa;
        b.mu_stable_Pa[i] = 0.0;
        b.viscosity_Pa_s[i] = 0.0;
    }
    return b;
}

} // namespace shearwake::test
