#pragma once

#include "engines/engine.hpp"

namespace shearwake {

/// Fourier in x and y, Gauss-Lobatto-Legendre elements in z, implicit in time with a step that
/// knows nothing of c_p. Media so far: layers on a rigid base, Kelvin-Voigt or lossless. Frames
/// come in order of time, each at all depths.
class SpectralEngine : public Engine {
public:
    Estimate estimate(const Case& c, int ranks) const override;
    std::vector<std::string> choices(const Case& c) const override;
    void run(const Case& c, const Comm& team, Observer& observer,
             Checkpoints* checkpoints) override;
};

} // namespace shearwake
