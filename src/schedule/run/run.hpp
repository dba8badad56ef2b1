// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/json.hpp"
#include "config/job.hpp"
#include "parallel/comm.hpp"
#include "pipeline/case_checkpoints.hpp"
#include "schedule/run/output_folder.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::schedule {

/// Arguments of every command that reads a job.
struct JobArguments {
    std::filesystem::path job;
    std::vector<std::string> overrides; // key=value
};

/// The machine that will run a job.
enum class Target {
    this_machine,
    elsewhere, // its memory and disk are unknown
};

/// Arguments of `shearwake run`.
struct RunArguments : JobArguments {
    std::filesystem::path out; // empty: out/<job name>
    int ranks_per_case = 0;    // 0: choose
    std::vector<std::string> only;
    pipeline::CheckpointSchedule checkpoints;
    bool retry_failed = false;
    bool fail_fast = false;
    bool extend = false;      // replace another plan in the folder and keep the cases of both
    bool allow_mixed = false; // continue in a folder with results of another version of the program
    std::string walltime;     // empty: the limit of the scheduler, or none
    std::filesystem::path log_json; // empty: none
    bool force = false;             // run although the estimates exceed memory, disk or time limit
    bool quiet = false;
    bool verbose = false; // print the choices of the engine
    bool is_round =
        false;         // results may ask for further cases, so the sweep does not end with the run
    bool json = false; // a JSON document instead of the closing message
    std::string resumed_by; // command line that resumes the run; empty: `run` with these arguments
};

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

/// Parses "key=value", the arguments of -S. Throws UsageError without a '='.
std::vector<config::Override> parse_overrides(const std::vector<std::string>& texts);

/// Rank 0 reads the job and the files that it names, relative to its folder; every rank gets the
/// same bytes. `points`: of adaptive axes, by default those of the first round. Collective. Throws
/// BadJob with all errors; prints nothing.
config::Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                     const Comm& world, const config::AxisPoints& points = {});

/// Computes the cases of this job, which every rank has, as `run` does. The members of the JSON
/// document are stored in `document` on rank 0 if it is not null, and otherwise printed.
/// Collective.
ExitCode run_job(const config::Job& job, const RunArguments& arguments, const Comm& world,
                 Json* document = nullptr);

} // namespace shearwake::schedule
