// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "schedule/run/output_folder.hpp"
#include "schedule/run/run_arguments.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::schedule {

/// The word, quoted for a shell if necessary.
std::string shell_word(const std::string& word);

/// The command that resumes a run: `shearwake run JOB -S ... --out ...`. An empty `out` stands for
/// the default.
std::string run_command_line(const std::filesystem::path& job,
                             const std::vector<std::string>& overrides,
                             const std::filesystem::path& out);

/// The command that runs a job as it was planned: on `ranks` ranks, with `ranks_per_case` ranks per
/// team (0: chosen by the program).
std::string planned_command_line(const std::filesystem::path& job,
                                 const std::vector<std::string>& overrides, int ranks,
                                 int ranks_per_case);

/// `shearwake COMMAND JOB` with the options of a run for selection, teams, limits and versions.
std::string command_line(std::string_view command, const RunArguments& arguments);

/// The command that resumes a run.
std::string run_command_line(const RunArguments& arguments);

/// `shearwake reduce DIR && shearwake report DIR`
std::string reduce_command_line(const OutputFolder& folder);

} // namespace shearwake::schedule
