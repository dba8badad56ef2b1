#pragma once

#include "neural/contact.hpp"

namespace shearwake::neural {

/// Lines with silence around them.
struct SilencedLines {
    Lines lines;
    double before_s = 0.0; // what was put before them
};

/// A stimulus with silence around it.
struct SilencedStimulus {
    PinStimulus stimulus;
    double before_s = 0.0; // what was put before it
};

/// `silence_s` of skin at rest before, and after it the last indentations that fade out as cos^2
/// within as long: where the rate is not the neurons' the stimulus is taken as periodic, and a jump
/// between its ends would ring at both of them. The end is lengthened until the whole lasts a whole
/// number of the neurons' samples. Without silence the stimulus is left as it is.
SilencedLines with_silence(const Lines& lines, double rate_Hz, double silence_s);
SilencedStimulus with_silence(const PinStimulus& stimulus, double silence_s);

} // namespace shearwake::neural
