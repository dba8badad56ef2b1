#pragma once

#include "config/job.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake {

/// "key=value" as given to -S. Throws UsageError without a '='.
Override parse_override(const std::string& text);

/// Rank 0 reads the file and the maps it names (paths relative to it), every rank gets the same
/// bytes. Collective. Throws BadJob with all mistakes; prints nothing.
Job load_job(const std::filesystem::path& path, const std::vector<std::string>& overrides,
             const Comm& world);

} // namespace shearwake
