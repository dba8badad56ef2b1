// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// Runs `work` on every rank. If it throws on any rank, all ranks throw the error of the lowest
/// failed rank: a UsageError, FileFailure or FieldDiverges keeps its type, everything else
/// (including lack of memory) becomes a CaseFailure. `work` must not communicate. Collective.
void together(const Comm& comm, const std::function<void()>& work);

/// Runs `work` on rank 0 only and handles errors as together() does. Intended for work on the file
/// system. Collective.
void on_root(const Comm& comm, const std::function<void()>& work);

/// The implementation of fail_together().
class FailTogether {
public:
    explicit FailTogether(const Comm& comm);
    ~FailTogether();
    FailTogether(const FailTogether&) = delete;
    FailTogether& operator=(const FailTogether&) = delete;

    /// Ends the work of this rank. Call it once on every rank, in a catch block if `work` threw.
    /// Throws on all ranks if it threw on any. Collective.
    void settle(std::exception_ptr thrown);

private:
    const Comm& comm_;
    int depth_;
};

/// As together() for `work` that communicates over `comm`, also through FFTW and HDF5. A rank may
/// fail alone at any place. The other ranks then throw PeerFailed at their next collective call,
/// and all ranks meet at the end of fail_together().
///
/// Every collective call inside is preceded by a reduction in which each rank reports whether it
/// has failed; a rank that fails takes part in the reduction of the call that it does not reach.
/// Hence all ranks have made the same collective calls when the failure is detected. Requirements:
///  - Code between catches no std::exception and communicates in no catch block or destructor.
///    HDF5 files that ranks share are abandoned, not closed (h5::Id).
///  - Other libraries are called after Comm::before_collective().
/// Calls may be nested. Collective.
template <class Work>
void fail_together(const Comm& comm, const Work& work) {
    FailTogether scope(comm);
    std::exception_ptr thrown;
    try {
        work();
    } catch (...) {
        thrown = std::current_exception();
    }
    scope.settle(std::move(thrown));
}

} // namespace shearwake
