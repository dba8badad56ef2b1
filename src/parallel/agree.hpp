// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// Runs `work` on every rank. If it throws on any rank, all ranks throw the error of the lowest
/// failed rank: a UsageError or a FileFailure keeps its type, everything else (including lack of
/// memory) becomes a CaseFailure. `work` must not communicate. Collective.
void together(const Comm& comm, const std::function<void()>& work);

/// Runs `work` on rank 0 only and handles errors as together() does. Intended for work on the file
/// system. Collective.
void on_root(const Comm& comm, const std::function<void()>& work);

} // namespace shearwake
