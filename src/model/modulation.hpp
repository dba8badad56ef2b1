#pragma once

#include "model/envelope.hpp"
#include "model/trajectory.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake {

/// A named composition. `kind` is the field's name for it ("AM-STM"); it decides nothing.
struct Modulation {
    std::string kind;
    Trajectory trajectory;
    Envelope envelope;
    /// Simultaneous foci, seen from the place that moves; they share the power of the one that is
    /// there if none are given.
    std::vector<Vec2> foci_m = {};
    bool operator==(const Modulation&) const = default;
};

/// Where the foci are at time t [m].
std::vector<Vec2> foci(const Modulation& modulation, double t_s);

/// The frequency of the first periodic part (envelope first, then trajectory), if there is one; a
/// single path that is drawn again and again is none [Hz].
std::optional<double> modulation_frequency_Hz(const Modulation& modulation);

} // namespace shearwake
