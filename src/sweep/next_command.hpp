#pragma once

#include "sweep/commands.hpp"
#include "sweep/output_folder.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// A word as a shell takes it back.
std::string shell_word(const std::string& word);

/// The command that goes on with a run: `shearwake run JOB -S ... --out ...`. An empty `out` is the
/// default one.
std::string run_command_line(const std::filesystem::path& job,
                             const std::vector<std::string>& overrides,
                             const std::filesystem::path& out);

/// The same with the part of the sweep, the teams and the versions that the run was told.
std::string run_command_line(const RunArguments& arguments);

/// `shearwake reduce DIR && shearwake report DIR`
std::string reduce_command_line(const OutputFolder& folder);

} // namespace shearwake
