// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

#include <string>
#include <vector>

namespace shearwake::app {

/// Overrides that reduce a job to one case without its sweep, followed by those of the arguments.
/// Collective.
std::vector<std::string> one_case_overrides(const schedule::JobArguments& arguments,
                                            const Comm& world);

} // namespace shearwake::app
