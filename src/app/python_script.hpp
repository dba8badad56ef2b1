// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace shearwake::app {

/// Runs a script of analysis/report with the first Python that has the packages which the figures
/// need, and returns its exit code (-1: it could not be started). Throws UsageError if there is no
/// such Python or no such script. Not collective: rank 0 calls it.
int run_python_script(const std::string& script, const std::vector<std::string>& arguments);

} // namespace shearwake::app
