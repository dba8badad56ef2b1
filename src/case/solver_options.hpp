// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/options/layered_options.hpp"
#include "engines/pstd/options/pstd_options.hpp"
#include "engines/spectral/options/spectral_options.hpp"

#include <variant>

namespace shearwake {

/// The options of the engine that computes a case. A new engine adds its options here and its
/// constructor to engines/registry/make_engine.cpp.
using SolverOptions = std::variant<LayeredOptions, SpectralOptions, PstdOptions>;

} // namespace shearwake
