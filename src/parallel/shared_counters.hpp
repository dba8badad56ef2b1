// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

namespace shearwake {

/// Integers in the memory of rank 0 to which every rank adds by one-sided communication
/// (MPI_Fetch_and_op), without participation of rank 0. Initially zero. Construction and
/// destruction are collective, all other calls are not.
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
};

} // namespace shearwake
