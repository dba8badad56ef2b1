// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "kwave/run.hpp"

#include <fmt/format.h>
#include <unistd.h>

namespace shearwake::kwave {

void check_arguments(const Arguments& a) {
    const auto refuse = [](const std::string& what) { throw UsageError(what); };
    if (!a.checkpoint.empty() && a.checkpoint_interval_s <= 0.0 && a.checkpoint_steps <= 0)
        refuse("--checkpoint_file requires --checkpoint_interval or --checkpoint_timesteps");
    if (a.checkpoint.empty() && (a.checkpoint_interval_s > 0.0 || a.checkpoint_steps > 0))
        refuse("--checkpoint_interval and --checkpoint_timesteps require --checkpoint_file");
    if (a.output.empty()) refuse("-o requires the name of a file, but is empty");
    for (const auto& path : {a.output, a.checkpoint}) {
        if (path.empty()) continue;
        std::error_code error;
        const auto folder = path.parent_path();
        if (!std::filesystem::is_directory(folder, error))
            refuse(fmt::format("{}: the folder does not exist", path.string()));
        if (::access(folder.c_str(), W_OK) != 0)
            refuse(fmt::format("{}: the folder is not writable", path.string()));
        const auto found = std::filesystem::status(path, error);
        if (found.type() == std::filesystem::file_type::none)
            refuse(fmt::format("{}: {}", path.string(), error.message()));
        if (std::filesystem::is_directory(found))
            refuse(fmt::format("{} is a folder", path.string()));
        if (std::filesystem::exists(found) && !std::filesystem::is_regular_file(found))
            refuse(fmt::format("{} is not a regular file", path.string()));
        if (std::filesystem::equivalent(path, a.input, error))
            refuse(fmt::format("{} would replace the input file", path.string()));
    }
    if (!a.checkpoint.empty() && std::filesystem::weakly_canonical(a.checkpoint) ==
                                     std::filesystem::weakly_canonical(a.output))
        refuse("the checkpoint and the output have the same name");
}

} // namespace shearwake::kwave
