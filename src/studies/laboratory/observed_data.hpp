// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/json.hpp"
#include "base/vectors.hpp"
#include "problem/case/case.hpp"
#include "studies/laboratory/laboratory.hpp"

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// The surface of a scan as shearwake.laboratory.measure_scan writes it: <prefix>.json and
/// <prefix>.f64. None of these functions is collective. All throw UsageError (environment) if a
/// file does not have the expected content.
struct ConvertedData {
    std::string data, sha256; // the file of the user
    std::vector<std::string> notes;
    std::size_t repetitions = 0;
    Vec2 covered_from_m, covered_to_m; // bounding box of the nodes with data
};

ConvertedData read_surface(const std::filesystem::path& prefix);

/// Reads `values.size()` numbers from position `first` on.
void read_numbers(const std::filesystem::path& prefix, std::size_t first, std::span<double> values);

/// Removes both files.
void remove_converted(const std::filesystem::path& prefix);

/// The members of a request of shearwake.laboratory.measure_scan that follow from the arguments and
/// the vibrometer of a case, if it has one.
Json scan_request(const MeasureArguments& arguments, const Case& c);

/// Warns on the standard error of overrides of what the scan replaces. Not collective.
void warn_of_overrides(const MeasureArguments& arguments);

/// Converts a file of a user by that script into <prefix>.json and <prefix>.f64. Throws UsageError
/// if it is not a usable scan; the script prints the reason. Not collective.
void convert_scan(const std::filesystem::path& data, const Json& request,
                  const std::filesystem::path& prefix);

} // namespace shearwake::laboratory
