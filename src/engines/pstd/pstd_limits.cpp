// SPDX-License-Identifier: BSD-3-Clause
#include "engines/limits.hpp"
#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/study_limits.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pstd {

std::vector<Remark> PstdEngine::limits(const Case& c) const {
    if (c.study()) {
        const std::string trouble = study_trouble(c);
        if (trouble.empty()) return {};
        return {{Severity::error, "solver.pstd.study", trouble}};
    }
    std::vector<Remark> refused;
    if (std::ranges::any_of(c.record.volume_fields,
                            [](VolumeField field) { return field != VolumeField::u; }))
        refused.push_back(
            {Severity::error, "record.volume_fields",
             "requests more than the displacement \"u\", which is all that the engine \"pstd\" "
             "stores; solver.engine = \"spectral\" also stores strain and stress"});
    if (!std::holds_alternative<GaussianFootprint>(c.scene().load.footprint))
        refused.push_back({Severity::error, "load.footprint",
                           "the engine \"pstd\" supports only Gaussian foci, but this is an array; "
                           "\"layered\" and \"spectral\" support both"});
    for (std::size_t i = 0; i < c.scene().medium.bodies.size(); ++i)
        if (c.scene().medium.bodies[i].rigid)
            refused.push_back({Severity::error, fmt::format("medium.body[{}].rigid", i + 1),
                               "only the engine \"spectral\" supports rigid bodies; the engine "
                               "\"pstd\" needs the "
                               "material of the body"});
    const std::vector<Remark> losses = engines::refused_losses(c);
    refused.insert(refused.end(), losses.begin(), losses.end());
    return refused;
}

engines::Edges PstdEngine::edges(const Case& c) const {
    const bool absorb =
        std::get<PstdOptions>(c.solver).edges == PstdEdges::absorbing || c.domain.sponge_m > 0.0;
    return absorb ? engines::Edges::layer : engines::Edges::periodic;
}

} // namespace shearwake::pstd
