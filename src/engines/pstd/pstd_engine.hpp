#pragma once

#include "engines/engine.hpp"

namespace shearwake {

/// k-Wave's staggered pseudospectral scheme (pstd/stepper.hpp) for a case: explicit in time with a
/// step that the fastest wave sets, so that c_p is held to a multiple of c_s. Layers, bodies and
/// maps, Kelvin-Voigt or lossless; Gaussian foci; waves absorbed below, and above unless nothing is
/// there. Frames come in order of time, each at all depths.
class PstdEngine : public Engine {
public:
    Estimate estimate(const Case& c, int ranks) const override;
    std::vector<std::string> choices(const Case& c) const override;
    void run(const Case& c, const Comm& team, Observer& observer,
             Checkpoints* checkpoints) override;
};

} // namespace shearwake
