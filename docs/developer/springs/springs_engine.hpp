// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::springs {

/// A Winkler foundation without mass: u_z = p length / modulus at each point of the surface.
class SpringsEngine : public engines::Engine {
public:
    engines::Resources resources(const Case& c, int ranks) const override;
    /// Its runs are not stopped.
    std::vector<std::string> choices(const Case&) const override { return {}; }
    std::vector<Remark> limits(const Case& c) const override;
    engines::Capabilities capabilities(const Case&) const override { return {}; }
    engines::StepChooser step_chooser(const Case&) const override { return {}; }
    engines::StepRefinement refine_time_step(const Case& c) const override {
        return {.options = c.solver, .change = ""};
    }
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override;
};

} // namespace shearwake::springs
