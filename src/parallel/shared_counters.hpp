// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// Integers in the memory of rank 0 to which every rank adds without participation of rank 0: in
/// shared memory if all ranks run on one host, otherwise by one-sided communication
/// (MPI_Fetch_and_op), which MPICH completes only while rank 0 is in a call of MPI. Initially zero.
/// Construction and destruction are collective, all other calls are not.
class SharedCounters {
public:
    SharedCounters(const Comm& comm, int count);
    ~SharedCounters();
    SharedCounters(const SharedCounters&) = delete;
    SharedCounters& operator=(const SharedCounters&) = delete;

    /// Adds `amount` to counter `which` (from 0) and returns its previous value.
    long fetch_add(int which, long amount);
    long read(int which) { return fetch_add(which, 0); }

private:
    MPI_Win window_ = MPI_WIN_NULL;
    long* memory_ = nullptr; // of rank 0, if it is shared
};

/// A question that only the root of a team can answer and that all ranks ask in a loop. They
/// communicate about once per interval, since ranks that share cores lose milliseconds at every
/// synchronisation.
class SpacedQuestion {
public:
    /// Not collective.
    SpacedQuestion(const Comm& team, double interval_s);
    /// The root's answer, on all ranks; false between two intervals, without communication.
    /// `answer` is called on the root only. Call it equally often on all ranks. Collective.
    bool ask(const std::function<bool()>& answer);

private:
    const Comm& team_;
    double interval_s_;
    long asked_ = 0, last_ = 0, next_ = 1; // numbers of calls; the ranks communicate in call next_
    Clock::time_point last_at_;
};

} // namespace shearwake
