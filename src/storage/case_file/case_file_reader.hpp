// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/record.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake::storage {

/// Metadata and scalars of a complete case file, without series and fields.
struct CaseSummary {
    std::map<std::string, std::string> texts; // root attributes that are text
    std::map<std::string, double> numbers;    // root attributes that are numbers
    std::vector<Variable> scalars;            // in the order of the file
    std::vector<Variable> shapes; // the other variables of the root group, without their values
};

/// Throws Error with the reason if the file is truncated, damaged or not a case file; its checksum
/// is verified first. Not collective.
CaseSummary read_case_summary(const std::filesystem::path& path);
/// Reads the file without verifying the checksum: HDF5 may crash on a damaged file, and with it
/// this process.
CaseSummary read_unverified_summary(const std::filesystem::path& path);

/// Whether the file exists, can be opened, is complete and belongs to the case with that id.
bool is_whole(const std::filesystem::path& path, const std::string& id);

} // namespace shearwake::storage
