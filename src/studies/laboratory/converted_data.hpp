// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "studies/laboratory/fit.hpp"

#include <cstddef>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// The files that shearwake.laboratory.measure_scan writes: <prefix>.json and <prefix>.f64. None
/// of these functions is collective. All throw UsageError (environment) if a file does not have the
/// expected content.
struct ConvertedData {
    std::string data, sha256; // the file of the user
    std::vector<std::string> notes;
    double rate_Hz = 0.0, noise_m_s = 0.0;
    // Of the surface:
    std::size_t repetitions = 0;
    Vec2 covered_from_m, covered_to_m; // bounding box of the nodes with data
    // Of the velocities:
    std::vector<Vec2> points_m;
    std::size_t samples = 0;
    double start_s = 0.0; // of the first sample after the trigger
    double delay_s = 0.0; // of the trigger after the start of the load
    Vec3 direction;
    bool is_line = false;
};

ConvertedData read_surface(const std::filesystem::path& prefix);
ConvertedData read_velocities(const std::filesystem::path& prefix);

/// Reads `values.size()` numbers from position `first` on.
void read_numbers(const std::filesystem::path& prefix, std::size_t first, std::span<double> values);

/// Removes both files.
void remove_converted(const std::filesystem::path& prefix);

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
