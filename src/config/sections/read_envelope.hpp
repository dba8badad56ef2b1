// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "problem/load/envelope.hpp"

namespace shearwake::config {

/// Reads the keys am_... of a modulation: a sine or a square wave.
Gain read_am_gain(Reader& reader);

/// Reads one table of [[load.modulation.envelope]].
Gain read_gain(Reader reader);

} // namespace shearwake::config
