// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "schedule/run/run_arguments.hpp"

namespace shearwake::converge {

/// Arguments of `run`, of which `out` is the folder of the sweep, and `only` the cases to study.
struct ConvergeArguments : schedule::RunArguments {
    std::size_t cases = 3; // without `only`: number of cases to study
};

/// The command `converge`: computes refined cases in the subfolder `converge` and estimates the
/// errors of all columns. Collective over the world.
ExitCode converge_job(const ConvergeArguments& arguments, const Comm& world);

} // namespace shearwake::converge
