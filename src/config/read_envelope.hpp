#pragma once

#include "config/reader.hpp"
#include "model/envelope.hpp"

namespace shearwake {

/// The keys am_... of a modulation: a sine, or a square wave.
Gain read_am_gain(Reader& reader);

/// One table of [[load.modulation.envelope]].
Gain read_gain(Reader reader);

} // namespace shearwake
