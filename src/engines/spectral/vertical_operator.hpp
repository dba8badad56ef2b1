#pragma once

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/skyline_matrix.hpp"

#include <vector>

namespace shearwake {

/// Compressional motion is far faster than any step: a quarter makes it unconditionally stable, the
/// little more keeps what it couples to so as well.
constexpr double stabilising_lambda = 0.26;

/// What the implicit operator is made of, at every node of every element
/// ([element * nodes + node]), laterally constant. The matrix is
///     M/dt^2 + 0.26 K_lambda + K_m + C/(2 dt),
/// m = max(mu_accurate/12, mu_stable/4 - 0.98 rho/(kappa dt)^2), kappa^2 the largest eigenvalue of
/// K_1, the stiffness of unit mu, against displacement on the element: 1/12 makes shear motion
/// fourth order in dt, and what lies above it makes it stable at any step.
struct Background {
    std::vector<double> density_kg_m3, lambda_Pa, mu_accurate_Pa, mu_stable_Pa, viscosity_Pa_s;
    std::vector<double> swirl_viscosity_Pa_s; // absorbs below a half-space
    /// Of the forces: with mu_accurate_Pa, and the viscosity theta mu_accurate_Pa. No stiffer than
    /// the implicit operator bears alone, or rounding, which strains kept apart do not see, grows.
    std::vector<double> force_lambda_Pa;
    std::vector<double> theta_s; // of each element
};

/// The background of a medium without bodies. Throws CaseFailure for a loss law that it does not
/// know.
Background background_of(const DepthMesh& mesh, const Medium& medium);

/// The motion of one |k| over depth, u_r = i U(z), u_t = i V(z), u_z = W(z), on spectral elements:
///     a = integral of lambda (W' - kU)^2 + 2 mu (k^2 U^2 + W'^2) + mu (U' + kW)^2   (P-SV)
///       + mu (V'^2 + k^2 V^2)                                                        (SH)
/// and, where an absorber is, a dissipation of swirl only,
///     integral of swirl_viscosity ((U' - kW)^2 + V'^2 + k^2 V^2),   U, V, W the velocities' here:
/// it takes shear waves and leaves potential flow alone, which reaches as deep as the domain is
/// wide. with the surface traction as natural condition, the mass diagonal (the nodes' own
/// quadrature) and the last level held (rigid base). A pencil is [2 level + {U, W}][part] of all
/// levels that move, then [level][part] of V.
class VerticalOperator {
public:
    VerticalOperator(const DepthMesh& mesh, Background background);

    std::ptrdiff_t levels() const { return levels_; } // that move
    std::ptrdiff_t psv() const { return 2 * levels_; }
    std::ptrdiff_t unknowns() const { return 3 * levels_; }
    std::ptrdiff_t nodes() const { return nodes_; } // of an element
    double mass_kg_m2(std::ptrdiff_t level) const { return mass_[static_cast<std::size_t>(level)]; }
    /// Lanes of the two factors of one pencil.
    std::ptrdiff_t factor_size() const { return psv_matrix_.entries() + sh_matrix_.entries(); }

    /// Assembles and factorises the implicit operator for eight k at once.
    void factorise_implicit(Lanes k, double dt_s, Lanes* factor) const;

    /// Solves with that, in place.
    void solve_implicit(const Lanes* factor, Lanes* pencil) const;

    /// x.A x of the implicit operator A of the counted parts. Overwrites the pencil.
    Lanes implicit_form(const Lanes* factor, Lanes* pencil, const Lanes* counted) const;

    /// -K u - C (u - before)/dt, added to `force`; `rate` is 1/dt.
    void add_internal_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                            Lanes* force) const;

    /// Twice the kinetic energy per area [J/m^2] of the counted parts, with the background's mass.
    Lanes twice_kinetic(double rate, const Lanes* u, const Lanes* before,
                        const Lanes* counted) const;

    /// The stabilising shear modulus at a place of stiffness mu in an element, for the largest k.
    double stabilised_mu_Pa(std::size_t element, double mu_Pa, double k_rad_m, double dt_s) const;

private:
    struct Element {
        double slope;   // 2 / h
        double half;    // h / 2
        double density; // the least of the background's here
        bool absorbs;
    };
    Lanes implicit_mu(std::size_t element, std::ptrdiff_t node, Lanes k, double dt_s) const;
    void add_swirl_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                         Lanes* force) const;
    void assemble_psv(Lanes k, double dt_s, Lanes* matrix) const;
    void assemble_sh(Lanes k, double dt_s, Lanes* matrix) const;
    double d(std::ptrdiff_t q, std::ptrdiff_t i) const {
        return derivative_[static_cast<std::size_t>(q * nodes_ + i)];
    }
    std::size_t point(std::size_t element, std::ptrdiff_t node) const {
        return element * static_cast<std::size_t>(nodes_) + static_cast<std::size_t>(node);
    }

    std::vector<Element> elements_;
    Background background_;
    double finest_;                  // eigenvalue of the reference element's finest mode
    std::vector<double> mass_;       // per level [kg/m^2]
    std::vector<double> derivative_; // of the reference element
    std::vector<double> weights_;
    std::ptrdiff_t nodes_, levels_;
    SkylineMatrix psv_matrix_, sh_matrix_;
};

} // namespace shearwake
