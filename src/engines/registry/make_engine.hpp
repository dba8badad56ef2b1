// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <memory>

namespace shearwake::engines {

/// Creates the engine selected by the case's solver options. Not collective.
std::unique_ptr<Engine> make_engine(const SolverOptions& solver);

/// Whether the engine saves checkpoints, from which an interrupted case is resumed.
bool saves_checkpoints(const SolverOptions& solver);

} // namespace shearwake::engines
