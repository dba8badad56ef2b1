// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/work.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace shearwake::cost {

/// Performance model of a machine: the rates of the engines' kinds of work while all ranks compute
/// independently at the same time, and the costs of transposes and files. Defaults are those of a
/// server of 2020. docs/how-to/cluster.md explains the model.
struct Machine {
    engines::Rates rates;        // of the kinds that have been measured
    double message_s = 2e-6;     // time of an all-to-all per partner
    double transposed_B_s = 1e9; // that a rank sends per second in an all-to-all
    double file_s = 0.015;       // overhead per case: journal, file, flushes
    double written_B_s = 0.5e9;  // that all ranks together write per second
    std::string measured;        // where and when; empty: all values are defaults
    bool operator==(const Machine&) const = default;
};

/// machine-<processor>-<instruction set>-<ranks>.json in the cache folder, see cache_file();
/// nothing if there is no cache.
std::optional<std::filesystem::path> machine_file(int ranks);

/// Reads the machine from the file. Returns the defaults if the file is absent, damaged, or was
/// written for another processor or by another version of this program.
Machine read_machine(const std::filesystem::path& file);
/// Adds the measurements of `machine` to the file. The file is replaced atomically, so other
/// processes may write it at the same time. Returns whether this succeeded.
bool keep_machine(const Machine& machine, const std::filesystem::path& file);

/// Rank 0 reads the machine for `ranks` ranks; every rank gets the same values, since all must make
/// the same plan. Collective.
Machine known_machine(int ranks, const Comm& world);

/// Broadcasts the machine of rank 0. Collective.
Machine machine_of_root(const Machine& machine, const Comm& world);

/// Measures the overhead of the files of a case and the rate at which files are written, in a
/// temporary subfolder of `where`. Throws UsageError (environment) if `where` is not writable. Not
/// collective.
void measure_files(const std::filesystem::path& where, const Comm& alone, Machine& machine);

} // namespace shearwake::cost
