// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/job.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::schedule {

/// Parses "key=value", the arguments of -S. Throws UsageError without a '='.
std::vector<config::Override> parse_overrides(const std::vector<std::string>& texts);

/// Rank 0 reads the job and the files that it names, relative to its folder; every rank gets the
/// same bytes. `points`: of adaptive axes, by default those of the first round. Collective. Throws
/// BadJob with all errors; prints nothing.
config::Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
                     const Comm& world, const config::AxisPoints& points = {});

} // namespace shearwake::schedule
