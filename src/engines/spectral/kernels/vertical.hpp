// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"

#include <cmath>

namespace shearwake::spectral {

/// The maximum degree of an element plus one.
constexpr std::ptrdiff_t most_nodes = 17;

/// Constants of one element.
struct VerticalElement {
    double slope;     // 2 / h
    double half;      // h / 2
    double density;   // whose inertia stabilises stiffness: the least one, 0 at light bodies
    double lambda_Pa; // least one of the background in this element
    double theta_s;   // viscosity over mu_accurate
    bool absorbs;     // whether it has swirl viscosity
};

/// Material below the end of an absorber (kernels/slices.hpp).
struct Termination {
    double density_kg_m3, modulus_Pa; // of compressional waves
};

/// The data of VerticalOperator as arrays; materials are indexed by [element * nodes + node].
struct VerticalArrays {
    /// Nodes per element; moving levels; total number of elements.
    std::ptrdiff_t nodes, levels, elements;
    const VerticalElement* element;
    const double *derivative, *weights; // of the reference element: [node][node]; [node]
    const double* mass_kg_m2;           // per level
    double finest;                      // eigenvalue of the reference element's finest mode
    const double *lambda_Pa, *mu_accurate_Pa, *mu_stable_Pa, *mu_greatest_Pa, *viscosity_Pa_s;
    const double *swirl_viscosity_Pa_s, *force_lambda_Pa;
    const Termination* termination; // null above a rigid base
    SkylineRows psv, sh;
};

// All kernels process eight wavenumbers at once; k is one block. The formulae are given in
// engines/spectral/depth/vertical_operator.hpp.

/// The implicit operator A, or the quadratic form A - C/(2 dt) - K/4 of the change of the
/// displacement in the energy of the scheme.
enum class Operator { implicit, of_change };

/// Assembly of the operators.
struct AssemblyKernels {
    /// Assemble the lower triangles of the P-SV and the SH matrix.
    void (*assemble_psv)(const VerticalArrays& v, Operator which, const Block& k, double dt_s,
                         Block* matrix);
    void (*assemble_sh)(const VerticalArrays& v, Operator which, const Block& k, double dt_s,
                        Block* matrix);
};

/// Memory that is read right after a kernel and is prefetched during its computations.
struct NeededSoon {
    const Block* from = nullptr;
    std::ptrdiff_t count = 0;
};

/// Application of the explicit operator to one pencil, for one block of wavenumbers.
struct VerticalKernels {
    /// Adds -K u - C (u - before) rate to `force`.
    void (*add_internal_force)(const VerticalArrays& v, const Block& k, double rate, const Block* u,
                               const Block* before, Block* force, NeededSoon soon);
    /// Twice the kinetic energy per area [J/m^2], summed over the parts with weights `counted`.
    Block (*twice_kinetic)(const VerticalArrays& v, double rate, const Block* u,
                           const Block* before, const Block* counted);
};

/// Compressional waves are far too fast for any step. A share of 1/4 of lambda makes them
/// unconditionally stable; the excess serves the shear stiffness of motion that changes the volume.
constexpr double stabilising_lambda = 0.26;
/// Share of the stiffness of a moving node that its inertia stabilises.
constexpr double stable_share = 0.98;

/// The greatest modulus S whose stiffness the inertia of an element stabilises,
///     S K_1 <= inertia M_1 + 0.01 K_lambda,   inertia = 0.98 rho/dt^2,
/// with the stiffness K_1 of unit mu and the mass M_1 of unit density. K_lambda is that of the
/// least implicit lambda, of which the implicit operator takes 0.01 more than stability requires.
/// `vertical` is the greatest eigenvalue of the slopes. For all motion K_1 <= 2 (k^2 + vertical)
/// M_1. Motion that preserves volume (W' = k U) has at most `shear`; the estimate for all other
/// motion splits off W' - k U, for which K_lambda pays. docs/explanation/engine-spectral.md
/// derives it ("Stability"). S decreases with k.
[[gnu::always_inline]] inline double stabilised_modulus_Pa(double k2, double vertical,
                                                           double inertia, double lambda_Pa) {
    const double both = k2 + vertical, paid_Pa = (stabilising_lambda - 0.25) * lambda_Pa;
    if (!(lambda_Pa > 0.0)) return 0.5 * inertia / both;
    const double less = k2 < vertical ? k2 : vertical;
    const double apart = 2.0 * (both - 2.0 * less) / both;
    const double shear = both + 4.0 * vertical * k2 / both;
    const double compression = inertia * apart / paid_Pa;
    const double difference = shear - compression;
    const double greatest =
        0.5 * (shear + compression +
               std::sqrt(difference * difference + 4.0 * compression * apart * less));
    return inertia / (greatest < 2.0 * both ? greatest : 2.0 * both);
}

} // namespace shearwake::spectral
