// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "case/remark.hpp"

#include <vector>

namespace shearwake::engines {

/// Errors for the layers that are neither lossless nor Kelvin-Voigt, for engines that step in time.
std::vector<Remark> refused_losses(const Case& c);

} // namespace shearwake::engines
