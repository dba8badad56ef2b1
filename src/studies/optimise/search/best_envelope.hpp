// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/optimise/search/quotient.hpp"

#include <cstdint>
#include <vector>

namespace shearwake::optimise {

/// An envelope and its measures.
struct Envelope {
    Eigen::VectorXd values; // at the knots, from 0 to 1
    double eta = 0.0;
    double strength = 0.0; // focal rms divided by that of the unmodulated load
};

/// The measures of an envelope.
Envelope measured(const Forms& forms, Eigen::VectorXd values);
Envelope unmodulated(const Forms& forms);

/// What an envelope must reach, both from 0 to 1. A uniformity above 0 needs the forms of the path.
struct Required {
    double strength = 0.0, uniformity = 0.0;
    bool is_met_by(const Forms& forms, const Eigen::VectorXd& envelope) const;
};

/// Local search from one start for the largest eta with 0 <= e <= 1 that meets the requirements, by
/// sequential quadratic programming (SLSQP of NLopt), with one inequality per point of the path if
/// a uniformity is required. The result satisfies all constraints exactly and is at least as good
/// as the start. If none is found, which is possible only if the unmodulated load does not meet
/// them, its eta is 0. Not collective.
Envelope best_from(const Forms& forms, const Required& required, const Eigen::VectorXd& start);

/// `count` different starts: the unmodulated load, pseudo-random pauses of a full force, sines of
/// different frequencies and phases, and noise. The same for the same arguments.
std::vector<Eigen::VectorXd> starts(Eigen::Index knots, std::size_t count, std::uint64_t seed);

/// The best of the local searches from these starts. Not collective.
Envelope best_envelope(const Forms& forms, const Required& required,
                       const std::vector<Eigen::VectorXd>& starts);

/// False if the program was built without NLopt; the searches then throw.
extern const bool can_search;

} // namespace shearwake::optimise
