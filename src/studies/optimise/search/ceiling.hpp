// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/optimise/search/quotient.hpp"

namespace shearwake::optimise {

/// A proof that no envelope between 0 and 1 with at least this strength reaches `eta`: tau, weights
/// w >= 0 and mu >= 0 for which, with M = F + mu (N - eta D), the matrix
///     tau    -w'/2
///     -w/2   diag(w) - M
/// is positive semidefinite and tau < strength^2 S. Its form for (1, e) shows that
///     e'Me <= tau - sum w e (1 - e) <= tau < strength^2 S,
/// but an envelope that reached eta with this strength would have e'Me >= e'Fe >= strength^2 S.
/// It holds for envelopes that are linear between the knots.
struct Certificate {
    double strength = 0.0;
    double eta = 0.0;
    double mu = 0.0;
    double tau = 0.0;        // m^2, as F
    Eigen::VectorXd weights; // m^2
};

/// Whether the certificate is valid. If the least eigenvalue of the matrix is negative, by
/// rounding, tau is increased by its amount times 1 + e'e, at most 1 plus the number of knots. Not
/// collective.
bool is_valid(const Forms& forms, const Certificate& certificate);

/// The smallest eta, to a relative 1e-4, for which there is such a certificate: bisection over eta,
/// and for each a semidefinite program that is solved with a logarithmic barrier. Not collective.
Certificate ceiling(const Forms& forms, double strength);

/// The envelope of the semidefinite program of a bound, from 0 to 1: near the best envelope where
/// the bound is tight, but it may be too weak. Not collective.
Eigen::VectorXd relaxed_envelope(const Forms& forms, const Certificate& certificate);

} // namespace shearwake::optimise
