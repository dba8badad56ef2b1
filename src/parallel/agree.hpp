#pragma once

#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// Runs `work` on every rank; when it throws on any of them, all ranks throw the message of the
/// lowest rank that failed: a UsageError or a FileFailure stays one, everything else (out of memory
/// too) becomes a CaseFailure. `work` must not communicate. Collective.
void together(const Comm& comm, const std::function<void()>& work);

/// The same with `work` on rank 0 only: file-system work. Collective.
void on_root(const Comm& comm, const std::function<void()>& work);

} // namespace shearwake
