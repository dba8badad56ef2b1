// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/registry/check.hpp"

namespace shearwake {

/// The part of `check` about bodies and maps: bodies that the grid does not resolve or that cross
/// the periodic edges, and maps outside the domain.
std::vector<Remark> check_variation(const Case& c);

} // namespace shearwake
