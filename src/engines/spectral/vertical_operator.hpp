#pragma once

#include "engines/spectral/depth_mesh.hpp"
#include "engines/spectral/lanes.hpp"

#include <vector>

namespace shearwake {

/// The P-SV problem of one |k| over depth, u_r = i U(z), u_z = W(z), on spectral elements:
///     a(u, v) = integral of lambda (W' - kU)(Z' - kV) + 2 mu (k^2 U V + W' Z')
///               + mu (U' + kW)(V' + kZ),
/// with the surface traction as natural condition, the mass diagonal (the nodes' own quadrature)
/// and the last level held (rigid base). Unknown 2 level + 0 is U, + 1 is W.
class VerticalOperator {
public:
    VerticalOperator(const DepthMesh& mesh, const Medium& medium);

    std::ptrdiff_t unknowns() const { return unknowns_; }
    /// Entries of a row of the lower band, the diagonal included.
    std::ptrdiff_t band() const { return 2 * nodes_; }
    const std::vector<double>& mass() const { return mass_; } // per unknown [kg/m^2]

    /// Lower band of M/dt^2 + a_lambda K_lambda + a_mu K_mu + C/(2 dt) for eight k at once, row by
    /// row: matrix[row * band + (column - row + band - 1)]. a_mu = 1/12, which makes shear motion
    /// fourth order in dt, raised element by element where their finest mode needs more to be
    /// stable: 1/4 - 1/(omega dt)^2. So there is no limit on the step.
    void assemble(Lanes k, double dt_s, Lanes* matrix) const;

    /// -K u - C (u - before)/dt of all four parts, added to `force`; arrays are
    /// [unknown][part] of lanes. `rate` is 1/dt.
    void add_internal_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                            Lanes* force) const;

private:
    struct Element {
        double density, lambda, mu, eta;
        double slope; // 2 / h
        double half;  // h / 2
    };
    Lanes stabilising_mu(const Element& el, Lanes k, double dt_s) const;

    std::vector<Element> elements_;
    double finest_; // eigenvalue of the reference element's finest mode
    std::vector<double> mass_;
    std::vector<double> derivative_; // of the reference element
    std::vector<double> weights_;
    std::ptrdiff_t nodes_; // of an element
    std::ptrdiff_t unknowns_;
};

/// L D L^T of a banded matrix in place, lanes apart. The matrices here are positive definite.
void factorise(std::ptrdiff_t unknowns, std::ptrdiff_t band, Lanes* matrix);

/// Solves for the four parts in place, x[unknown][part].
void solve(std::ptrdiff_t unknowns, std::ptrdiff_t band, const Lanes* factor, Lanes* x);

} // namespace shearwake
