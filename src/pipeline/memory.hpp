// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

namespace shearwake::pipeline {

/// Memory in bytes that each rank may use: the free memory of the machine, limited by the control
/// group of a batch system or container, divided among the ranks on the machine, and at most the
/// limit of `ulimit -v`. Infinity if unknown. Collective; the minimum over all machines, equal on
/// all ranks.
double memory_per_rank_B(const Comm& world);

/// The peak memory of this rank so far. Not collective.
double peak_memory_B();
/// The current memory of this rank. Not collective.
double resident_memory_B();

/// The memory that a case requires on one rank of a team: the estimate of the engine and the data
/// of the recorder.
double memory_needed_B(const Case& c, int ranks);
/// The same if the engine is already known, which then need not repeat its estimate.
double memory_needed_B(const Case& c, int ranks, const engines::Engine& engine);

/// Size of the case file in bytes, including the overhead of HDF5; `engine_B` of it is written by
/// the engine. Not collective.
double case_file_B(const Case& c, double engine_B);

} // namespace shearwake::pipeline
