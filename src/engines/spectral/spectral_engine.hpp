// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/spectral_plan.hpp"

#include <deque>
#include <map>
#include <string>

namespace shearwake::spectral {

/// Fourier series in x and y, Gauss-Lobatto-Legendre elements in z, implicit steps in time whose
/// length is independent of c_p. Supports layers, bodies and maps that are Kelvin-Voigt or
/// lossless, on a rigid base or a half-space. Passes the frames in order of time, each at all
/// depths.
class SpectralEngine : public engines::Engine {
public:
    engines::Resources resources(const Case& c, int ranks) const override;
    std::vector<std::string> choices(const Case& c) const override;
    std::vector<Remark> limits(const Case& c) const override;
    engines::Capabilities capabilities(const Case& c) const override;
    engines::StepChooser step_chooser(const Case& c) const override;
    engines::StepRefinement refine_time_step(const Case& c) const override;
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override;

private:
    struct Planned {
        Case given;
        SpectralPlan plan;
    };
    /// The plan of the case, which is made once for its resources, its choices and its run. Valid
    /// until the next call. Throws engines::StepNotChosen.
    const SpectralPlan& plan_of(const Case& given, engines::ChoiceLimit limit = {}) const;
    const SampledVariation& variation_of(const SpectralPlan& plan) const;
    mutable std::deque<Planned> planned_;                        // of the latest cases
    mutable std::map<std::string, SampledVariation> variations_; // by key_of_variation()
};

} // namespace shearwake::spectral
