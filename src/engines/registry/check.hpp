// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// Everything about the physics of a case that is doubtful (warning) or makes the result
/// meaningless (error): resolution of the focus and of the shear wave, a focus that leaves the
/// domain, waves that wrap around within the run, periods that do not fit, times off the run, and
/// the limits of the engine. Not collective.
std::vector<Remark> check(const Case& c);

/// How the files of a case were read and what they contain, for the user. Not collective.
std::vector<std::string> files_read(const Case& c);

/// The part of `check` about bodies and maps: bodies that the grid does not resolve or that cross
/// the periodic edges, and maps outside the domain.
std::vector<Remark> check_variation(const Case& c);

} // namespace shearwake
