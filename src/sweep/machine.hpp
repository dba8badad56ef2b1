#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <optional>
#include <string>

namespace shearwake {

/// What `plan` and `run` believe of a machine: what `bench machine` has measured, or else that of a
/// server of 2020 with its ranks in one box. See docs/cluster.md, the model.
struct Machine {
    double layered_factor = 1.0;  // seconds over the engine's own estimate, one rank
    double spectral_factor = 1.0; //
    double message_s = 2e-6;      // an all-to-all takes this for each partner
    double transposed_B_s = 1e9;  // what a rank sends in an all-to-all, each second
    double file_s = 0.015;        // a case beside its solve: journal, file, flushes
    double written_B_s = 0.5e9;   // what all ranks together write, each second
    std::string measured;         // where and when; empty: assumed
};

/// machine.json in the folder of FFTW's plans, see wisdom_file(); nothing where none is kept.
std::optional<std::filesystem::path> machine_file();

/// What the file says; the assumptions where there is none, or none that can be read.
Machine known_machine();

/// What rank 0 knows, on every rank: they must come to the same plans. Collective.
Machine machine_of_root(const Comm& world);

/// Throws UsageError (environment) when it cannot be written.
void write_machine(const Machine& machine, const std::filesystem::path& file);

} // namespace shearwake
