// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "studies/optimise/search/quotient.hpp"

#include <filesystem>
#include <vector>

namespace shearwake::optimise {

/// The quadratic forms of a quotient from the case files of all knots (knot_case()), which store
/// every frame: sums with the weights of the measures. Exact, since the field is linear in the
/// envelope. `c`: the case without envelope. Throws FileFailure. Not collective.
Forms gram_forms(const Case& c, const Quotient& quotient,
                 const std::vector<std::filesystem::path>& knot_files);

} // namespace shearwake::optimise
