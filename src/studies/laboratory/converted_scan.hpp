// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "studies/laboratory/fit.hpp"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>

namespace shearwake::laboratory {

/// The members of a request of shearwake.laboratory.measure_scan that follow from the arguments and
/// the vibrometer of a case, if it has one.
nlohmann::ordered_json scan_request(const ScanArguments& arguments, const Case& c);

/// Warns on the standard error of overrides of what the scan replaces. `is_fit`: the motion is
/// computed and filtered as by the vibrometer of the job. Not collective.
void warn_of_overrides(const ScanArguments& arguments, bool is_fit);

/// Converts a file of a user by that script into <prefix>.json and <prefix>.f64. Throws UsageError
/// if it is not a usable scan; the script prints the reason. Not collective.
void convert_scan(const std::filesystem::path& data, const nlohmann::ordered_json& request,
                  const std::filesystem::path& prefix);

} // namespace shearwake::laboratory
