// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

#include <filesystem>

namespace shearwake::laboratory {

/// A scan of a user and the job that describes it.
struct ScanArguments : schedule::JobArguments {
    std::filesystem::path data;
    std::filesystem::path out; // empty: out/<job name>.fit
    double least_quality = 0.0;
    bool outwards = false; // z and positive velocities of the scan point out of the skin
};

/// The command `fit`: estimates the keys of [uncertain] from a measured scan. Collective over the
/// world.
ExitCode fit_job(const ScanArguments& arguments, const Comm& world);

} // namespace shearwake::laboratory
