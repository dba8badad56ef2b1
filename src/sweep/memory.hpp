#pragma once

#include "model/case.hpp"
#include "parallel/comm.hpp"

namespace shearwake {

/// Bytes that each rank may use: what the machine, and the control group that a batch system or a
/// container puts the program in, can still give, shared by the ranks on the machine; no more than
/// `ulimit -v` grants. Infinity where nobody says. Collective; the same on all ranks (the poorest
/// machine's).
double memory_per_rank_B(const Comm& world);

/// The most that this rank has had in memory so far. Not collective.
double peak_memory_B();
/// What this rank has in memory now. Not collective.
double resident_memory_B();

/// What a case needs on one rank of a team: the engine's estimate and what the recorder holds.
double memory_needed_B(const Case& c, int ranks);

} // namespace shearwake
