#pragma once

#include "model/envelope.hpp"
#include "model/trajectory.hpp"

#include <optional>
#include <string>

namespace shearwake {

/// A named composition. `kind` is the field's name for it ("AM-STM"); it decides nothing.
struct Modulation {
    std::string kind;
    Trajectory trajectory;
    Envelope envelope;
    bool operator==(const Modulation&) const = default;
};

/// The frequency of the first periodic part (envelope first, then trajectory), if there is one; a
/// single path that is drawn again and again is none [Hz].
std::optional<double> modulation_frequency_Hz(const Modulation& modulation);

} // namespace shearwake
