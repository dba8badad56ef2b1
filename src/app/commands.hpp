// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "reduce/reduce.hpp"
#include "schedule/run/run_arguments.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::app {

/// Each command has one function, in a file named after the command. The exceptions are `run`,
/// which is adaptive_run in this folder, `bench`, which is bench_command in bench/, and the
/// commands of python_command.hpp. All functions are collective over the world; commands that only
/// read or draw do their work on rank 0.

struct CheckArguments : schedule::JobArguments {
    bool json = false;
    schedule::Target target = schedule::Target::this_machine;
};

struct PlanArguments : CheckArguments {
    int ranks = 0;          // 0: the number of ranks of this program
    int ranks_per_case = 0; // 0: choose
    bool all_cases = false; // list every case of a long plan
};

/// `overrides` are the values of --set.
struct EvaluateArguments : schedule::JobArguments {
    std::filesystem::path out; // empty: out/<job name>.evaluate
    bool json = false;
};

struct ShowModulationArguments : schedule::JobArguments {
    std::filesystem::path picture; // empty: <job name>.modulation.png in the working directory
};

struct LensArguments : schedule::JobArguments {
    std::filesystem::path out; // empty: out/<job name>.lens
};

struct ShowArguments {
    std::filesystem::path case_file;
    bool json = false;
};

/// `job` is the file of --options.
struct MeasureArguments : schedule::JobArguments {
    std::filesystem::path data, out; // out empty: out/<job name>.measure
    std::filesystem::path fit;       // fit.json, whose estimates override the job; empty: none
    double high_pass_Hz = 0.0;       // 0: none
    double least_quality = 0.0;
    std::string gaps = "interpolate"; // interpolate, mask
    std::size_t repetitions = 8;      // for the uncertainty
    bool draws = true;                // the report
};

struct FitArguments : schedule::JobArguments {
    std::filesystem::path data, out; // out empty: out/<job name>.fit
    double least_quality = 0.0;
};

struct DiffArguments {
    std::filesystem::path now, reference; // output folders, or tables (CSV)
    std::vector<std::string> tolerances;  // COLUMN=RELATIVE
    std::filesystem::path tolerance_file; // TOML; empty: none
    bool json = false;
};

struct ReduceArguments {
    std::filesystem::path folder;
    bool json = false;
    reduce::ErrorColumns errors = reduce::ErrorColumns::omitted;
};

/// Arguments of `run`, of which `out` is the folder of the sweep, and `only` the cases to study.
struct ConvergeArguments : schedule::RunArguments {
    std::size_t cases = 3; // without `only`: number of cases to study
};

struct StatusArguments {
    std::filesystem::path folder;
    bool verify = false; // read the case files and check their checksums
    bool json = false;
};

struct VerifyArguments {
    std::filesystem::path folder;
    bool json = false;
    bool quiet = false;
};

struct RespondArguments {
    std::filesystem::path motion;  // CSV or HDF5; empty: a prescribed carrier
    std::string group;             // of the HDF5 file; empty: /traces or the root group
    std::filesystem::path options; // TOML with [afferents]; empty: defaults
    std::vector<std::string> overrides;
    std::filesystem::path out;   // HDF5; empty: only the summary is printed
    double duration_ms = 1000.0; // of a prescribed carrier
    double modulation_Hz = 0.0;  // reference frequency of phase locking for a motion; 0: none

    bool gives_radius() const;
};

ExitCode check_command(const CheckArguments& arguments, const Comm& world);
ExitCode plan_command(const PlanArguments& arguments, const Comm& world);
/// Computes one case of a job, without its sweep, and prints the values of its table.
ExitCode evaluate_command(const EvaluateArguments& arguments, const Comm& world);
ExitCode status_command(const StatusArguments& arguments, const Comm& world);
/// Checks every case file, the plan, the journals and the index against their checksums.
ExitCode verify_command(const VerifyArguments& arguments, const Comm& world);
ExitCode reduce_command(const ReduceArguments& arguments, const Comm& world);
/// Computes refined cases in the subfolder `converge` and estimates the errors of all columns.
ExitCode converge_command(const ConvergeArguments& arguments, const Comm& world);
ExitCode diff_command(const DiffArguments& arguments, const Comm& world);
ExitCode show_command(const ShowArguments& arguments, const Comm& world);
/// Draws path, speed and envelope of the job's first case.
ExitCode show_modulation_command(const ShowModulationArguments& arguments, const Comm& world);
/// Writes the thickness and the field of the lens of the job's first case.
ExitCode lens_command(const LensArguments& arguments, const Comm& world);
/// Computes the measures of a measured scan.
ExitCode measure_command(const MeasureArguments& arguments, const Comm& world);
/// Estimates the keys of [uncertain] from a measured scan.
ExitCode fit_command(const FitArguments& arguments, const Comm& world);
ExitCode respond_command(const RespondArguments& arguments, const Comm& world);

/// Reads the command line and calls the function of its command.
ExitCode program(int argc, char** argv, const Comm& world);

} // namespace shearwake::app
