// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <set>
#include <string>

namespace shearwake::kwave {

/// The options of the command `kwave`, which are those of k-Wave's compiled programs and
/// u_split_field_raw, I_raw, I_avg, precision and output_precision.
struct Arguments {
    std::filesystem::path input, output;
    std::set<std::string> records; // see pstd::Recorder; empty: p
    long first_step = 1;           // that is recorded, from 1
    long steps = 0;                // 0: those of the input
    int threads = 0;               // 0: not specified
    int progress_percent = 5;
    int gzip_level = 0;
    int verbose = 0; // 0, 1 or 2
    std::string device = "cpu";
    int gpu = -1; // its number; -1: the first, or that of this rank of the machine
    bool copies_sensor_mask = false;
    std::filesystem::path checkpoint; // empty: none
    double checkpoint_interval_s = 0.0;
    long checkpoint_steps = 0;
    std::string precision = "double", output_precision = "single";
};

/// Throws UsageError for options that contradict each other, and for names of files that cannot be
/// written. Not collective.
void check_arguments(const Arguments& arguments);

/// Runs the scheme of pstdElastic3D on an input file and writes the output file of k-Wave, under a
/// temporary name until it is complete. A run that ends at a checkpoint also writes the output, in
/// which t_index is the last step. Throws UsageError with the exit code 1 of k-Wave for all errors.
/// Collective.
ExitCode run(const Arguments& arguments, const Comm& world);

} // namespace shearwake::kwave
