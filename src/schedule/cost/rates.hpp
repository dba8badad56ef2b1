// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>

namespace shearwake::cost {

/// The seconds of a core for a unit of the work of an engine (engines::Resources::work), which runs
/// of this version of the program have recorded on this machine in
/// rates-<processor>-<instruction set>.json in the cache folder, see cache_file(). Nothing without
/// a record. Not collective.
std::optional<double> recorded_rate_s(const std::string& engine);

/// Records the rate of a run: the geometric mean of it and of the former rate, so that no single
/// run determines all estimates. Without a cache it records nothing. Not collective.
void record_rate_s(const std::string& engine, double rate_s);

/// What every command prints where it has no recorded rate.
inline constexpr const char* unknown_time = "time: not known on this machine yet";

} // namespace shearwake::cost
