// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <filesystem>
#include <functional>
#include <hdf5.h>

namespace shearwake::storage {

/// Compressed or sparse values up to this size are read in any case.
constexpr double always_allowed_B = 64e6;

/// Runs `read` in a forked child. HDF5 1.10 crashes on some damaged or malicious files, which
/// cannot be detected in advance. The child has the same memory, so if it does not crash, this
/// process does not crash either when it then does the same. Throws Error if the child crashes,
/// takes too long, or needs more memory than limit_trial_memory() allows; does nothing if no child
/// can be created. Not collective; `read` must not communicate.
void try_in_child(const std::filesystem::path& file, const std::function<void()>& read);

/// In the child of try_in_child(), limits the memory that it may allocate from now on; otherwise
/// has no effect. A chunk of an HDF5 file can decompress to far more than it states.
void limit_trial_memory(double more_B);

/// User files may refer to any file on the machine, but only the file itself is read: throws Error
/// with the name of the first link of the file that leads to another file, or of the
/// first dataset whose values are in other files or whose chunks are larger than itself. Follows no
/// link. Returns the bytes of the values of all datasets.
double require_self_contained(hid_t file);

} // namespace shearwake::storage

namespace shearwake::h5 {

/// Registers a file of a team that a failure has left open on this rank. Not collective.
void abandon_file(hid_t file) noexcept;

/// Closes the abandoned files, with everything that is open in them. Files that not all ranks have
/// abandoned remain open until the program ends. Call it after a failure on which the ranks have
/// agreed (fail_together). Collective.
void close_abandoned(const Comm& comm);

} // namespace shearwake::h5
