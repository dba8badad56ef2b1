// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"

#include <fmt/format.h>

namespace shearwake::engines {

double Resources::memory_per_rank_B() const {
    double bytes = program_B;
    for (const Allocation& array : arrays)
        bytes += array.bytes;
    return bytes;
}

double volumes_B(const Case& c, double levels) {
    double components = 0.0;
    for (const VolumeField field : c.record.volume_fields)
        components += static_cast<double>(components_of(field).size());
    return sizeof(double) * levels * components * static_cast<double>(c.domain.nx * c.domain.ny) *
           static_cast<double>(c.record.volumes_s.size());
}

std::vector<std::string> notes_of(const std::vector<Choice>& choices) {
    std::vector<std::string> notes;
    for (const Choice& choice : choices)
        notes.push_back(choice.text);
    return notes;
}

std::vector<Remark> warnings_of(const std::vector<Choice>& choices) {
    std::vector<Remark> warnings;
    for (const Choice& choice : choices)
        if (!choice.key.empty()) warnings.push_back({Severity::warning, choice.key, choice.text});
    return warnings;
}

std::vector<Remark> refused_edges(const Case& c) {
    std::vector<Remark> refused;
    if (c.time.regime == Regime::periodic)
        refused.push_back(
            {Severity::error, "time.regime",
             fmt::format("is \"periodic\", which the engine \"{}\" does not support, since it "
                         "steps from a state of rest; compute many repetitions with time.regime = "
                         "\"transient\", or use solver.engine = \"layered\"",
                         engine_name(c.solver))});
    if (c.domain.edges == DomainEdges::periodic) return refused;
    refused.push_back(
        {Severity::error, "domain.edges",
         fmt::format("is \"open\", which the engine \"{}\" does not support; use a margin "
                     "domain.sponge_mm that absorbs waves, or solver.engine = \"layered\"",
                     engine_name(c.solver))});
    return refused;
}

std::vector<Remark> refused_losses(const Case& c) {
    std::vector<Remark> refused;
    for (const Layer& layer : c.scene.medium.layers)
        if (!newtonian_viscosity_Pa_s(layer.loss))
            refused.push_back(
                {Severity::error, "solver.engine",
                 fmt::format(
                     "\"{}\" supports only lossless or Kelvin-Voigt layers (viscosity_Pa_s), but "
                     "layer \"{}\" has another loss law; \"layered\" supports all laws",
                     engine_name(c.solver), layer.name)});
    return refused;
}

} // namespace shearwake::engines
