// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/choices.hpp"
#include "engines/spectral/spectral_engine.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "problem/medium/body.hpp"

#include <fmt/format.h>

namespace shearwake::spectral {

std::vector<Remark> SpectralEngine::limits(const Case& c) const {
    std::vector<Remark> refused = engines::refused_losses(c);
    for (std::size_t i = 0; i < c.scene().medium.bodies.size(); ++i)
        if (is_fluid(c.scene().medium.bodies[i]) && !c.scene().medium.bodies[i].rigid)
            refused.push_back({Severity::error, fmt::format("medium.body[{}].c_s_m_s", i + 1),
                               "is 0, a fluid, which only the engine \"pstd\" supports"});
    for (Remark& remark : engines::refused_edges(c))
        refused.push_back(std::move(remark));
    for (Remark& remark : rigid_limits(c))
        refused.push_back(std::move(remark));
    for (Remark& warning : receptors_near_bodies(with_rigid_bodies(c)))
        refused.push_back(std::move(warning));
    for (Remark& warning : engines::warnings_of(
             variation_choices(with_rigid_bodies(c), std::get<SpectralOptions>(c.solver))))
        refused.push_back(std::move(warning));
    return refused;
}

engines::Edges SpectralEngine::edges(const Case& c) const {
    return c.domain.sponge_m > 0.0 ? engines::Edges::sponge : engines::Edges::periodic;
}

bool SpectralEngine::probes_step(const Case& c) const {
    return !std::get<SpectralOptions>(c.solver).time_step_s;
}

double SpectralEngine::probed_step_s(const Case& c) const {
    return plan_of(c).time.step_s;
}

Case SpectralEngine::with_step(const Case& c, double step_s) const {
    Case given = c;
    std::get<SpectralOptions>(given.solver).time_step_s = step_s;
    return given;
}

} // namespace shearwake::spectral
