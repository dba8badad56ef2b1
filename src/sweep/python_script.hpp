#pragma once

#include <string>
#include <vector>

namespace shearwake {

/// Runs a script of analysis/report with the first Python that has what figures need, and returns
/// its exit code (-1: it could not be started). Throws UsageError where there is no such Python or
/// no such script. Not collective: rank 0 calls it.
int run_python_script(const std::string& script, const std::vector<std::string>& arguments);

} // namespace shearwake
