// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/skin/contact.hpp"

namespace shearwake::neural {

/// Lines with silence before and after.
struct SilencedLines {
    Lines lines;
    double before_s = 0.0; // duration of the silence that precedes the lines
};

/// A stimulus with silence before and after.
struct SilencedStimulus {
    PinStimulus stimulus;
    double before_s = 0.0; // duration of the silence that precedes the stimulus
};

/// Adds `silence_s` of skin at rest before the stimulus; afterwards the last indentations decrease
/// as cos^2 over the same time. Without silence a jump between the ends would cause ringing at both
/// ends, because resampling to the neurons' rate treats the stimulus as periodic. The end is
/// extended so that the total duration is an integer number of samples of the neurons. The stimulus
/// is returned unchanged if `silence_s` is 0. Not collective.
SilencedLines with_silence(const Lines& lines, double rate_Hz, double silence_s);
SilencedStimulus with_silence(const PinStimulus& stimulus, double silence_s);

} // namespace shearwake::neural
