// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "kwave/files.hpp"
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

std::string check_step(const Input& input, const std::string& name, const Comm& world) {
    const auto& grid = input.setup.grid;
    const double alone_s = world.min(input.limits.alone_s);
    if (grid.dt_s > alone_s)
        throw UsageError(fmt::format("{}: dt is {:.6g} s, which is unstable in this medium: steps "
                                     "above {:.6g} s are unstable",
                                     name, grid.dt_s, alone_s));
    pstd::Extremes extremes;
    extremes.p_modulus_Pa = world.max(input.limits.p_modulus_Pa);
    extremes.p_viscosity_Pa_s = world.max(input.limits.p_viscosity_Pa_s);
    extremes.least_density_kg_m3 = world.min(input.limits.density_kg_m3);
    const double safe_s = pstd::safe_step_s(extremes, pstd::cubic_spacing_m(grid));
    if (grid.dt_s <= safe_s) return "";
    return fmt::format("dt is {:.6g} s; steps up to {:.6g} s are stable for any arrangement of "
                       "these materials",
                       grid.dt_s, safe_s);
}

} // namespace shearwake::kwave
