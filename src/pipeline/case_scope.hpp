// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "storage/hdf5/abandoned_files.hpp"

namespace shearwake::pipeline {

/// fail_together() for `work` that opens files through MPI. Their owners must be local to `work`.
/// Collective.
template <class Work>
void fail_together_with_files(const Comm& team, const Work& work) {
    try {
        fail_together(team, work);
    } catch (const Error&) { // on all ranks
        h5::close_abandoned(team);
        throw;
    }
}

} // namespace shearwake::pipeline
