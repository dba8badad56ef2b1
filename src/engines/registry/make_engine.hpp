// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <memory>
#include <vector>

namespace shearwake::engines {

/// Creates the engine selected by the case's solver options. Not collective.
std::unique_ptr<Engine> make_engine(const SolverOptions& solver);

/// One of each, in the order of SolverOptions.
std::vector<std::unique_ptr<Engine>> all_engines();

} // namespace shearwake::engines
