// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace shearwake {

/// What a group of modules needs.
struct PythonPackages {
    std::string purpose; // for messages: "figures"
    std::vector<std::string> modules;
    std::string debian; // the packages that contain them
};
extern const PythonPackages figure_packages, explorer_packages, scan_packages;

/// Runs `python3 -m module`, such as "shearwake.report", with the first Python that has the
/// packages, and returns its exit code (-1: it could not be started). `errors`: receives the
/// standard error of the module, which is printed otherwise. Throws UsageError if this Python
/// or the package is missing. Not collective: rank 0 calls it.
int run_python_module(const std::string& module, const std::vector<std::string>& arguments,
                      const PythonPackages& packages = figure_packages,
                      std::string* errors = nullptr);

} // namespace shearwake
