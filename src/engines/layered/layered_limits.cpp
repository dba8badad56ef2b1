// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/layered_engine.hpp"

namespace shearwake::layered {

std::vector<Remark> LayeredEngine::limits(const Case& c) const {
    std::vector<Remark> refused;
    const auto refuse = [&](const char* key, const char* reason) {
        refused.push_back({Severity::error, key, reason});
    };
    if (!c.record.volumes_s.empty())
        refuse("record.volumes_ms",
               "requests the field below the surface, which the engine \"layered\" does not store; "
               "use solver.engine = \"spectral\"");
    constexpr const char* only_layers = "the engine \"layered\" supports only layers; use "
                                        "solver.engine = \"spectral\" for bodies and maps";
    if (!c.scene().medium.bodies.empty()) refuse("medium.body", only_layers);
    if (c.scene().medium.map) refuse("medium.map", only_layers);
    return refused;
}

} // namespace shearwake::layered
