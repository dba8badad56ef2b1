// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/kernels/skyline.hpp"
#include "engines/spectral/kernels/vertical.hpp"

#include <optional>
#include <vector>

namespace shearwake::spectral {

/// Structure of symmetric positive definite matrices of a chain of spectral elements, for eight
/// wavenumbers in parallel. An unknown couples only to those of its own elements, and the fill-in
/// of L D L^T stays there. Each row of the lower triangle is stored from the first unknown of its
/// element to the diagonal, which takes half of the memory of a band. The computations are in
/// SkylineKernels.
class SkylineMatrix {
public:
    /// Structure for elements of `degree` with `per_level` unknowns at each of the first `levels`
    /// levels.
    SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree, std::ptrdiff_t per_level);

    std::ptrdiff_t entries() const { return entries_; } // per matrix
    /// Valid for the lifetime of this object.
    SkylineRows rows() const { return {rows_.data(), static_cast<std::ptrdiff_t>(rows_.size())}; }

private:
    std::vector<SkylineRow> rows_;
    std::ptrdiff_t entries_ = 0;
};

/// The compressional stiffness that the implicit operator contains. A negative lambda is treated
/// explicitly: otherwise the operator of a background with the least lambda and the least mu of a
/// plane could be indefinite. Explicit, it increases the energy of the scheme.
inline double implicit_lambda_Pa(double lambda_Pa) {
    return lambda_Pa > 0.0 ? lambda_Pa : 0.0;
}

/// Coefficients of the implicit operator at every node of every element ([element * nodes + node]),
/// laterally constant. The matrix is
///     M/dt^2 + 0.26 K_lambda + K_m + C/(2 dt),
/// m = max(mu_accurate/12, mu_stable/4 - S), where S is the modulus that the inertia of the element
/// stabilises (stabilised_modulus_Pa), and 0 at light rigid bodies (DepthMesh::light). The value
/// 1/12 makes shear motion fourth order in dt; the excess above it makes the scheme stable at any
/// step.
struct Background {
    std::vector<double> density_kg_m3, lambda_Pa, mu_accurate_Pa, mu_stable_Pa, viscosity_Pa_s;
    std::vector<double> mu_greatest_Pa;       // of all materials at a node
    std::vector<double> swirl_viscosity_Pa_s; // absorbs shear waves below a half-space
    /// For the forces, which use mu_accurate_Pa and the viscosity theta mu_accurate_Pa. Its
    /// stiffness must not exceed what the implicit operator alone stabilises; otherwise rounding
    /// errors, which the separately advanced strains do not contain, grow.
    std::vector<double> force_lambda_Pa;
    std::vector<double> theta_s; // per element
};

/// The background of a medium without bodies. Throws CaseFailure for an unsupported loss law. Not
/// collective.
Background background_of(const DepthMesh& mesh, const Medium& medium);

/// Motion over depth for one |k|, u_r = i U(z), u_t = i V(z), u_z = W(z), on spectral elements:
///     a = integral of lambda (W' - kU)^2 + 2 mu (k^2 U^2 + W'^2) + mu (U' + kW)^2   (P-SV)
///       + mu (V'^2 + k^2 V^2)                                                        (SH)
/// and, in an absorber, a dissipation that acts on curl v alone,
///     integral of swirl_viscosity ((U' - kW)^2 + V'^2 + k^2 V^2),   with velocities U, V, W.
/// It damps shear waves but not potential flow, for which the absorber ends in the impedance of the
/// half-space (kernels/slices.hpp). The surface traction is the natural condition, the mass is
/// diagonal (quadrature at the nodes), and the last level is fixed (rigid base). A pencil is stored
/// as [2 level + {U, W}][part] for all moving levels, followed by [level][part] for V. No member
/// function is collective.
class VerticalOperator {
public:
    VerticalOperator(const DepthMesh& mesh, Background background);

    std::ptrdiff_t levels() const { return levels_; } // moving levels
    std::ptrdiff_t psv() const { return 2 * levels_; }
    std::ptrdiff_t unknowns() const { return 3 * levels_; }
    std::ptrdiff_t nodes() const { return nodes_; } // per element
    double mass_kg_m2(std::ptrdiff_t level) const { return mass_[static_cast<std::size_t>(level)]; }
    /// Number of Blocks in the two factors of one pencil.
    std::ptrdiff_t factor_size() const { return psv_matrix_.entries() + sh_matrix_.entries(); }

    /// Assembles and factorises an operator for the eight k [rad/m] of a block. Where the medium
    /// varies laterally, Operator::of_change is a lower bound.
    void factorise(Operator which, const Block& k, double dt_s, Block* factor) const;
    void factorise_implicit(const Block& k, double dt_s, Block* factor) const {
        factorise(Operator::implicit, k, dt_s, factor);
    }

    /// Solves in place with these factors.
    void solve_implicit(const Block* factor, Block* pencil) const;

    /// x.A x of the implicit operator A, summed over the parts with weights `counted`. Overwrites
    /// the pencil.
    Block implicit_form(const Block* factor, Block* pencil, const Block* counted) const;

    /// Adds -K u - C (u - before)/dt to `force`; `rate` is 1/dt. If `factor` is given, it is
    /// prefetched at the same time.
    void add_internal_force(const Block& k, double rate, const Block* u, const Block* before,
                            Block* force, const Block* factor = nullptr) const;

    /// Twice the kinetic energy per area [J/m^2] with the background's mass, summed over the parts
    /// with weights `counted`.
    Block twice_kinetic(double rate, const Block* u, const Block* before,
                        const Block* counted) const;

    /// The stabilising shear modulus [Pa] for a stiffness mu in an element, at the largest
    /// wavenumber.
    double stabilised_mu_Pa(std::size_t element, double mu_Pa, double k_rad_m, double dt_s) const;

private:
    /// Arrays for the kernels; valid for the lifetime of this object.
    VerticalArrays arrays() const;
    std::size_t point(std::size_t element, std::ptrdiff_t node) const {
        return element * static_cast<std::size_t>(nodes_) + static_cast<std::size_t>(node);
    }

    std::vector<VerticalElement> elements_;
    Background background_;
    double finest_;                  // eigenvalue of the reference element's finest mode
    std::vector<double> mass_;       // per level [kg/m^2]
    std::vector<double> derivative_; // of the reference element
    std::vector<double> weights_;
    std::ptrdiff_t nodes_, levels_;
    std::optional<Termination> termination_; // of an absorber
    const AssemblyKernels& assembly_;
    const VerticalKernels& kernels_;
    const SkylineKernels& solver_;
    SkylineMatrix psv_matrix_, sh_matrix_;
};

} // namespace shearwake::spectral
