#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "sweep/case_checkpoints.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// One function per verb of the program, each in a file of its name. All are collective over the
/// world; the ones that only read or draw do their work on rank 0.

struct JobArguments {
    std::filesystem::path job;
    std::vector<std::string> overrides; // key=value
};

struct PlanArguments : JobArguments {
    int ranks = 0; // 0: those of this program
    int ranks_per_case = 0;
};

struct RunArguments : JobArguments {
    std::filesystem::path out; // empty: out/<job name>
    int ranks_per_case = 0;    // 0: chosen
    std::vector<std::string> only;
    std::string shard; // "I/N"
    CheckpointSchedule checkpoints;
    bool retry_failed = false;
    bool fail_fast = false;
    bool allow_mixed = false;       // go on in a folder with results of another program
    std::string walltime;           // empty: the scheduler's, or none
    std::filesystem::path log_json; // empty: none
    bool quiet = false;
};

struct ShowModulationArguments : JobArguments {
    std::filesystem::path picture; // empty: <job file>.modulation.png, here
};

struct BenchArguments {
    std::string engine = "layered";
    // Of `spectral` and `pstd`:
    std::string grid; // points along x and y, levels or points; empty: the engine's own choice
    int steps = 20;
    // Of `spectral`:
    double contrast = 4.0;  // of a body's shear stiffness; 1: no body
    double sponge_mm = 0.0; // on each side
    int cases = 2000;       // of `sweep`
};

struct DiffArguments {
    std::filesystem::path now, reference; // output folders, or tables (CSV)
    std::vector<std::string> tolerances;  // COLUMN=RELATIVE
    std::filesystem::path tolerance_file; // TOML; empty: none
    std::filesystem::path json;           // where to write the differences; empty: nowhere
};

struct RespondArguments {
    std::filesystem::path motion;  // CSV or HDF5; empty: a prescribed carrier
    std::string group;             // of the HDF5 file; empty: /traces or its root
    std::filesystem::path options; // TOML with [afferents]; empty: defaults
    std::vector<std::string> overrides;
    std::filesystem::path out;   // HDF5; empty: only the summary is printed
    double duration_ms = 1000.0; // of a carrier
    double modulation_Hz = 0.0;  // that locking refers to, of a motion; 0: none

    bool gives_radius() const;
};

ExitCode check_command(const JobArguments& arguments, const Comm& world);
ExitCode plan_command(const PlanArguments& arguments, const Comm& world);
ExitCode run_command(const RunArguments& arguments, const Comm& world);
ExitCode status_command(const std::filesystem::path& folder, const Comm& world);
ExitCode reduce_command(const std::filesystem::path& folder, const Comm& world);
ExitCode report_command(const std::filesystem::path& folder, const Comm& world);
ExitCode diff_command(const DiffArguments& arguments, const Comm& world);
ExitCode show_command(const std::filesystem::path& case_file, const Comm& world);
/// Draws path, speed and envelope of the job's first case.
ExitCode show_modulation_command(const ShowModulationArguments& arguments, const Comm& world);
ExitCode respond_command(const RespondArguments& arguments, const Comm& world);
ExitCode bench_command(const BenchArguments& arguments, const Comm& world);

/// Reads the command line and calls one of them.
ExitCode program(int argc, char** argv, const Comm& world);

} // namespace shearwake
