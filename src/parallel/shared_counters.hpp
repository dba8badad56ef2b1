#pragma once

#include "parallel/comm.hpp"

namespace shearwake {

/// A few integers in rank 0's memory that every rank adds to without rank 0 taking part
/// (MPI one-sided fetch-and-add). Construction and destruction are collective, the rest is not.
class SharedCounters {
public:
    SharedCounters(const Comm& comm, int count);
    ~SharedCounters();
    SharedCounters(const SharedCounters&) = delete;
    SharedCounters& operator=(const SharedCounters&) = delete;

    /// The value before the addition.
    long fetch_add(int which, long amount);
    long read(int which) { return fetch_add(which, 0); }

private:
    MPI_Win window_ = MPI_WIN_NULL;
};

} // namespace shearwake
