// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/layered_engine.hpp"
#include "engines/layered/open_domain.hpp"

#include <fmt/format.h>

namespace shearwake::layered {
namespace {

bool is_lossless(const Layer& layer) {
    const auto* viscous = std::get_if<KelvinVoigt>(&layer.loss);
    return std::holds_alternative<Lossless>(layer.loss) ||
           (viscous && viscous->viscosity_Pa_s == 0.0);
}

} // namespace

std::vector<Remark> LayeredEngine::limits(const Case& c) const {
    std::vector<Remark> refused;
    const auto refuse = [&](const char* key, const char* reason) {
        refused.push_back({Severity::error, key, reason});
    };
    if (!c.record.volumes_s.empty())
        refuse("record.volumes_ms",
               "requests the field below the surface, which the engine \"layered\" does not store; "
               "use solver.engine = \"spectral\"");
    if (c.time.regime == Regime::periodic) {
        if (c.domain.edges != DomainEdges::open)
            refuse("time.regime", "is \"periodic\", which requires domain.edges = \"open\": waves "
                                  "that return through periodic edges would accumulate for ever");
        for (const Layer& layer : c.scene().medium.layers)
            if (is_lossless(layer))
                refused.push_back(
                    {Severity::error, "time.regime",
                     fmt::format("is \"periodic\", but layer \"{}\" is lossless: waves that are "
                                 "guided along it never decay, so that a load that has always "
                                 "repeated has no steady state; give it a viscosity_Pa_s or "
                                 "another loss law",
                                 layer.name)});
    }
    constexpr const char* only_layers = "the engine \"layered\" supports only layers; use "
                                        "solver.engine = \"spectral\" for bodies and maps";
    if (!c.scene().medium.bodies.empty()) refuse("medium.body", only_layers);
    if (c.scene().medium.map) refuse("medium.map", only_layers);
    return refused;
}

engines::Edges LayeredEngine::edges(const Case& c) const {
    return c.domain.edges == DomainEdges::open ? engines::Edges::open : engines::Edges::periodic;
}

std::vector<std::string> LayeredEngine::choices(const Case& c) const {
    if (c.domain.edges != DomainEdges::open) return {};
    const Domain solved = solved_domain(c);
    return {
        fmt::format("open edges: convolution with the response of the infinite plane on {} x {} "
                    "points, which the path and the footprint require",
                    solved.nx, solved.ny)};
}

} // namespace shearwake::layered
