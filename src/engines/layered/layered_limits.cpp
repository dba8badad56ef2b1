// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "engines/layered/layered_engine.hpp"
#include "engines/layered/load/time_step.hpp"
#include "engines/layered/response/stack_response.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <complex>
#include <fmt/format.h>
#include <numbers>
#include <optional>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

/// Smallest loss factor for which H and the loss are resolved, see RadialInterpolant.
constexpr double least_loss_factor = 1e-9;

/// The lowest and the highest frequency of the frames.
std::array<double, 2> frequencies_Hz(const Case& c) {
    return {1.0 / c.time.duration_s(), 0.5 / c.time.interval_s};
}

/// Why the steady state on a layer cannot be computed; empty if it can.
std::string obstacle_to_steady_state(const Case& c, const Layer& layer) {
    if (newtonian_viscosity_Pa_s(layer.loss) == 0.0)
        return fmt::format("is \"periodic\", but layer \"{}\" is lossless: waves that are guided "
                           "along it never decay, so that a load that has always repeated has no "
                           "steady state; give it a viscosity_Pa_s or another loss law",
                           layer.name);
    for (const double f_Hz : frequencies_Hz(c))
        if (const double factor = loss_factor(layer, f_Hz); !(factor >= least_loss_factor))
            return fmt::format(
                "is \"periodic\", but the loss factor of layer \"{}\" at {:.4g} Hz is {:.1e}, less "
                "than {:.0e}: waves that are guided along it hardly decay, so that their poles "
                "cannot be resolved; increase its loss (viscosity_Pa_s, or the exponent or "
                "strength of its law), or compute a transient",
                layer.name, f_Hz, factor, least_loss_factor);
    return "";
}

/// The layer with the largest ratio of its modulus to a typical one, or the reverse.
const Layer& most_extreme_layer(const Medium& medium) {
    return *std::ranges::max_element(medium.layers, {}, [](const Layer& layer) {
        return std::abs(std::log(static_shear_modulus(layer) / 1e4));
    });
}

/// A frequency at which H overflows.
std::optional<double> overflow_Hz(const Case& c) {
    for (const double f_Hz : frequencies_Hz(c)) {
        const StackResponse response(c.scene.medium, two_pi * f_Hz, std::vector{0.0});
        for (const double k_rad_m : {1e-3, 1.0}) {
            Complex h;
            response.evaluate(k_rad_m * std::numbers::pi / c.domain.spacing_m, {&h, 1});
            if (!std::isfinite(std::abs(h))) return f_Hz;
        }
    }
    return std::nullopt;
}

} // namespace

std::vector<Remark> LayeredEngine::limits(const Case& c) const {
    std::vector<Remark> refused;
    const auto refuse = [&](const char* key, const std::string& reason) {
        refused.push_back({Severity::error, key, reason});
    };
    if (!c.record.volumes_s.empty())
        refuse("record.volumes_ms",
               "requests the field below the surface, which the engine \"layered\" does not store; "
               "use solver.engine = \"spectral\"");
    const double samples = least_samples(c, std::get<LayeredOptions>(c.solver));
    if (samples > most_samples) {
        refuse("solver.layered.time_step_us",
               fmt::format("results in {:.3g} samples of the load in time, {:.3g} times the number "
                           "of frames; at most {:.0e} are supported: use a longer step, slower "
                           "modulations, a wider focus or a shorter run",
                           samples, samples / static_cast<double>(c.time.frames), most_samples));
        return refused;
    }
    if (c.time.regime == Regime::periodic) {
        if (c.domain.edges != DomainEdges::open)
            refuse("time.regime", "is \"periodic\", which requires domain.edges = \"open\": waves "
                                  "that return through periodic edges would accumulate for ever");
        for (const Layer& layer : c.scene.medium.layers)
            if (const std::string reason = obstacle_to_steady_state(c, layer); !reason.empty())
                refuse("time.regime", reason);
    }
    if (const auto f_Hz = overflow_Hz(c))
        refuse(
            "medium.layer",
            fmt::format("the response of the layers at {:.4g} Hz is not a finite number; correct "
                        "the density, speeds, loss and thickness of layer \"{}\"",
                        *f_Hz, most_extreme_layer(c.scene.medium).name));
    constexpr const char* only_layers = "the engine \"layered\" supports only layers; use "
                                        "solver.engine = \"spectral\" for bodies and maps";
    if (!c.scene.medium.bodies.empty()) refuse("medium.body", only_layers);
    if (c.scene.medium.map) refuse("medium.map", only_layers);
    return refused;
}

engines::Capabilities LayeredEngine::capabilities(const Case& c) const {
    const bool is_open = c.domain.edges == DomainEdges::open;
    return {.edges = is_open ? engines::Edges::open : engines::Edges::periodic,
            .steps_in_time = false,
            .has_open_edges = true,
            .has_tangential = !is_open};
}

std::vector<std::string> LayeredEngine::choices(const Case& c) const {
    return LayeredPlan(c, 1).notes();
}

} // namespace shearwake::layered
