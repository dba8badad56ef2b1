// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/kernels/skyline.hpp"

namespace shearwake::spectral {

/// The maximum degree of an element plus one.
constexpr std::ptrdiff_t most_nodes = 17;

/// Constants of one element.
struct VerticalElement {
    double slope;   // 2 / h
    double half;    // h / 2
    double density; // minimum of the background in this element
    double theta_s; // viscosity over mu_accurate
    bool absorbs;   // whether it has swirl viscosity
};

/// The data of VerticalOperator as arrays; materials are indexed by [element * nodes + node].
struct VerticalArrays {
    /// Nodes per element; moving levels; total number of elements.
    std::ptrdiff_t nodes, levels, elements;
    const VerticalElement* element;
    const double *derivative, *weights; // of the reference element: [node][node]; [node]
    const double* mass_kg_m2;           // per level
    double finest;                      // eigenvalue of the reference element's finest mode
    const double *lambda_Pa, *mu_accurate_Pa, *mu_stable_Pa, *viscosity_Pa_s;
    const double *swirl_viscosity_Pa_s, *force_lambda_Pa;
    SkylineRows psv, sh;
};

// All kernels process eight wavenumbers at once; k is one block. The formulae are given in
// engines/spectral/depth/vertical_operator.hpp.

/// Assembly of the implicit operator.
struct AssemblyKernels {
    /// Assemble the lower triangles of the P-SV and the SH matrix of the implicit operator.
    void (*assemble_psv)(const VerticalArrays& v, const Block& k, double dt_s, Block* matrix);
    void (*assemble_sh)(const VerticalArrays& v, const Block& k, double dt_s, Block* matrix);
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

/// Compressional waves are far too fast for any step. A share of 1/4 makes them unconditionally
/// stable; the excess does the same for the motion coupled to them.
constexpr double stabilising_lambda = 0.26;
/// Share of the stiffness of a moving node that its inertia stabilises.
constexpr double stable_share = 0.98;

/// Upper bound of the eigenvalues of unit shear stiffness relative to unit mass on an element, for
/// motion that preserves volume (W' = k U; the rest is governed by lambda). `vertical` is the
/// eigenvalue of the slopes. Plane waves have k^2 + vertical; at the ends of an element, where its
/// finest modes are concentrated, it is up to twice as large.
template <class Number>
[[gnu::always_inline]] inline Number greatest_stiffness(Number k2, double vertical) {
    return k2 + vertical + 4.0 * vertical * k2 / (k2 + vertical);
}

} // namespace shearwake::spectral
