// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"

#include <string>

namespace shearwake::pstd {

/// The reason why a case does not match the grid study of its solver: domain, times, depths, or
/// keys that have no effect with a study. Empty if it matches or has no study.
std::string study_trouble(const Case& c);

} // namespace shearwake::pstd
