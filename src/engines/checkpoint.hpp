// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace shearwake::engines {

/// The rows of a global array [total][row_length] that this rank holds.
struct StateRows {
    std::ptrdiff_t total = 0, start = 0, count = 0, row_length = 0;
};

/// A checkpoint that is being written. Every member function is collective over the team and called
/// in the same order on all ranks. Each row is held by exactly one rank; a rank may hold none.
/// Names are unique. An engine writes its number of steps as "step", which the journal reports.
class StateWriter {
public:
    virtual ~StateWriter() = default;
    virtual void put(const std::string& name, const StateRows& rows, const double* values) = 0;
    virtual void put(const std::string& name, double value) = 0; // identical on all ranks
};

/// A checkpoint that is being read, on any number of ranks and in any order of names. Every member
/// function is collective over the team; a rank may request any rows. Throws CaseFailure on all
/// ranks if `total` or `row_length` differ from the written ones.
class StateReader {
public:
    virtual ~StateReader() = default;
    virtual void get(const std::string& name, const StateRows& rows, double* values) = 0;
    virtual double get(const std::string& name) = 0;
};

/// Decides when to save and stores the checkpoints of a case. Collective.
class Checkpoints {
public:
    virtual ~Checkpoints() = default;
    /// Whether to save now. Called after every step but the last. Returns the same value on all
    /// ranks.
    virtual bool due() = 0;
    /// Writes a checkpoint. A failure to write (for example a full disk) is reported and does not
    /// end the case.
    virtual void save(const std::function<void(StateWriter&)>& write) = 0;
    /// Passes the newest complete checkpoint that belongs to this case and program version to
    /// `read`. Returns false, without calling `read`, if there is none.
    virtual bool restore(const std::function<void(StateReader&)>& read) = 0;
    /// Whether the engine should return because a stop was requested: after a save, or after
    /// stop_asked().
    virtual bool stop() const = 0;
    /// Whether a stop was requested, for engines that save nothing. Call it equally often on all
    /// ranks, as often as convenient: the ranks communicate about every 0.1 s. Returns the same
    /// value on all ranks.
    virtual bool stop_asked() { return false; }
};

/// Ends the computation of a case after stop_asked(). Thrown on all ranks of a team together and
/// caught by the engine.
struct StopRequested {};

/// Throws StopRequested if a stop was requested. Collective, see Checkpoints::stop_asked().
inline void end_if_asked(Checkpoints* checkpoints) {
    if (checkpoints && checkpoints->stop_asked()) throw StopRequested{};
}

} // namespace shearwake::engines
