// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/cost/machine.hpp"

#include <filesystem>

namespace shearwake::cost {

/// Measures the overhead of the files of a case and the rate at which files are written, in a
/// temporary subfolder of `where`. Throws UsageError (environment) if `where` is not writable. Not
/// collective.
void measure_files(const std::filesystem::path& where, const Comm& alone, Machine& machine);

} // namespace shearwake::cost
