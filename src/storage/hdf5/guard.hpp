// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <hdf5.h>

namespace shearwake::storage {

/// User files may refer to any file on the machine, but only the file itself is read: throws Error
/// with the name of the first link of the file that leads to another file, or of the
/// first dataset whose values are in other files. Follows no link.
void require_self_contained(hid_t file);

} // namespace shearwake::storage

namespace shearwake::h5 {

/// Registers a file of a team that a failure has left open on this rank. Not collective.
void abandon_file(hid_t file) noexcept;

/// Closes the abandoned files, with everything that is open in them. Files that not all ranks have
/// abandoned remain open until the program ends. Call it after a failure on which the ranks have
/// agreed (fail_together). Collective.
void close_abandoned(const Comm& comm);

} // namespace shearwake::h5
