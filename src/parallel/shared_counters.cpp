// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/shared_counters.hpp"

#include <algorithm>

namespace shearwake {

SharedCounters::SharedCounters(const Comm& comm, int count) {
    long* memory = nullptr;
    const MPI_Aint bytes = comm.is_root() ? count * static_cast<MPI_Aint>(sizeof(long)) : 0;
    MPI_Win_allocate(bytes, sizeof(long), MPI_INFO_NULL, comm.raw(), &memory, &window_);
    if (comm.is_root()) {
        MPI_Win_lock(MPI_LOCK_EXCLUSIVE, 0, 0, window_);
        std::fill_n(memory, count, 0L);
        MPI_Win_unlock(0, window_);
    }
    comm.barrier();
}

SharedCounters::~SharedCounters() {
    // Freeing is collective. During stack unwinding other ranks may not reach this point.
    if (std::uncaught_exceptions() == 0) MPI_Win_free(&window_);
}

long SharedCounters::fetch_add(int which, long amount) {
    long before = 0;
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, window_);
    MPI_Fetch_and_op(&amount, &before, MPI_LONG, 0, which, MPI_SUM, window_);
    MPI_Win_unlock(0, window_);
    return before;
}

} // namespace shearwake
