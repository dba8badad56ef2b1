// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/shared_counters.hpp"

#include <algorithm>
#include <atomic>

namespace shearwake {

namespace {

/// The ranks of `comm` if all of them run on this host; otherwise MPI_COMM_NULL. Collective.
MPI_Comm comm_of_one_host(const Comm& comm) {
    MPI_Comm host = MPI_COMM_NULL;
    MPI_Comm_split_type(comm.raw(), MPI_COMM_TYPE_SHARED, comm.rank(), MPI_INFO_NULL, &host);
    int ranks = 0;
    MPI_Comm_size(host, &ranks);
    if (ranks < comm.size()) MPI_Comm_free(&host);
    return host;
}

} // namespace

SharedCounters::SharedCounters(const Comm& comm, int count) {
    const MPI_Aint bytes = comm.is_root() ? count * static_cast<MPI_Aint>(sizeof(long)) : 0;
    long* memory = nullptr;
    if (MPI_Comm host = comm_of_one_host(comm); host != MPI_COMM_NULL) {
        MPI_Win_allocate_shared(bytes, sizeof(long), MPI_INFO_NULL, host, &memory, &window_);
        MPI_Aint size = 0;
        int unit = 0;
        MPI_Win_shared_query(window_, 0, &size, &unit, &memory_);
        MPI_Comm_free(&host);
    } else {
        MPI_Win_allocate(bytes, sizeof(long), MPI_INFO_NULL, comm.raw(), &memory, &window_);
    }
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
    if (memory_ != nullptr) return std::atomic_ref(memory_[which]).fetch_add(amount);
    long before = 0;
    MPI_Win_lock(MPI_LOCK_SHARED, 0, 0, window_);
    MPI_Fetch_and_op(&amount, &before, MPI_LONG, 0, which, MPI_SUM, window_);
    MPI_Win_unlock(0, window_);
    return before;
}

SpacedQuestion::SpacedQuestion(const Comm& team, double interval_s)
    : team_(team), interval_s_(interval_s), last_at_(Clock::now()) {}

bool SpacedQuestion::ask(const std::function<bool()>& answer) {
    if (++asked_ < next_) return false;
    bool found = false;
    long wait = 0;
    if (team_.is_root()) {
        found = answer();
        // The calls may become slower: the number of calls to the next question at most doubles.
        const auto calls = static_cast<double>(std::max(1L, asked_ - last_));
        const double since_s = seconds_since(last_at_);
        const double call_s = std::max(since_s, 1e-9) / calls;
        wait = static_cast<long>(std::clamp(interval_s_ / call_s, 1.0, 2.0 * calls));
    }
    found = team_.broadcast(found);
    last_ = asked_;
    next_ = asked_ + team_.broadcast(wait);
    last_at_ = Clock::now();
    return found;
}

} // namespace shearwake
