// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "optimise/forms.hpp"

namespace shearwake::optimise {

/// A proof that no envelope with |e| <= 1 and at least this strength reaches `eta`: weights w >= 0
/// and mu >= 0 with
///     diag(w) - F - mu (N - eta D) positive semidefinite   and   sum w < strength^2 S.
/// An envelope that reached eta would have e'Fe <= e'Fe + mu e'(N - eta D)e <= sum w e^2 <= sum w,
/// which is less than the strength requires.
struct Certificate {
    double strength = 0.0;
    double eta = 0.0;
    double mu = 0.0;
    Eigen::VectorXd weights; // m^2, as F
};

/// Whether the certificate is valid. `rounding`: by how much the least eigenvalue may be negative,
/// relative to the trace of F. Not collective.
bool is_valid(const Forms& forms, const Certificate& certificate, double rounding = 1e-12);

/// The smallest eta, to a relative 1e-4, for which there is such a certificate: bisection over eta,
/// and for each a semidefinite program that is solved with a logarithmic barrier. Not collective.
Certificate ceiling(const Forms& forms, double strength);

} // namespace shearwake::optimise
