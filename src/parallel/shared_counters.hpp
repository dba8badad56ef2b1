// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

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

} // namespace shearwake
