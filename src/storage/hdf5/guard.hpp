// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <functional>
#include <hdf5.h>

namespace shearwake::storage {

/// Runs `work` in a forked child and returns whether it ends, with or without an exception. HDF5
/// 1.10 crashes on some damaged or malicious files, which cannot be detected in advance. The child
/// has the same memory, so if it does not crash, this process does not crash either when it then
/// does the same. `seconds`: limit of the CPU time, after which the child counts as crashed.
/// Returns true if no child can be created. Not collective; `work` must not communicate.
bool survives(const std::function<void()>& work, double seconds = 60.0);

/// Throws Error if `read` crashes on the file.
void must_survive(const std::filesystem::path& file, const std::function<void()>& read);

} // namespace shearwake::storage

namespace shearwake::h5 {

/// Registers a file of a team that a failure has left open on this rank. Not collective.
void abandon_file(hid_t file) noexcept;

/// Closes the abandoned files, with everything that is open in them. Files that not all ranks have
/// abandoned remain open until the program ends. Call it after a failure on which the ranks have
/// agreed (fail_together). Collective.
void close_abandoned(const Comm& comm);

} // namespace shearwake::h5
