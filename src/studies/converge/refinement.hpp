// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::converge {

/// A case with one numerical parameter refined.
struct Refinement {
    std::string name;   // "spacing", "time", "domain"
    std::string change; // "half the spacing, 0.5 mm"
    Case physics;
    /// Ratio by which the refined quantity, the spacing or the step, is smaller.
    double ratio = 2.0;
    /// Order of convergence of the measures in that quantity; none: unknown.
    std::optional<double> order;
};

/// The case without frames and volumes in its record, which are not needed.
Case without_fields(Case c);

/// The case with half the spacing, with half the time step (or a quarter of the tolerance), and
/// with twice the domain. Each keeps all other parameters, and the measured region. Throws
/// UsageError for a grid study, whose grid is given. Not collective.
std::vector<Refinement> refinements(const Case& c);

/// The estimated error of the unrefined value, given the change of the value by the refinement:
/// |change| r^p / (r^p - 1) with the order p and the ratio r (Richardson), |change| without order.
double estimated_error(double change, const Refinement& refinement);

} // namespace shearwake::converge
