#pragma once

#include "model/record.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace shearwake {

/// What a finished case says of itself, without its series and fields.
struct CaseSummary {
    std::map<std::string, std::string> texts; // root attributes that are text
    std::map<std::string, double> numbers;    // root attributes that are numbers
    std::vector<Variable> scalars;            // in the order of the file
    std::vector<Variable> shapes;             // the other root variables, without their values
};

/// Throws Error with a reason when the file is truncated, damaged or not a case. Not collective.
CaseSummary read_case_summary(const std::filesystem::path& path);
/// The same without a guard: HDF5 may break down on the file, and this process with it.
CaseSummary read_summary_unguarded(const std::filesystem::path& path);

/// Whether the file is there, opens, is complete and is the case of that id.
bool is_whole(const std::filesystem::path& path, const std::string& id);

} // namespace shearwake
