// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <memory>

namespace shearwake::engines {

/// Creates the engine selected by the case's solver options. Not collective.
std::unique_ptr<Engine> make_engine(const SolverOptions& solver);

/// What the engine of the case offers for it. Not collective.
Capabilities capabilities_of(const Case& c);

} // namespace shearwake::engines
