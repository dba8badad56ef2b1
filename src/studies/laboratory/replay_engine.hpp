// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// Passes measured frames of the surface to an observer as an engine passes computed ones, so that
/// measurements have the same measures and files as simulations.
class ReplayEngine : public engines::Engine {
public:
    /// `prefix`: of the converted surface (ConvertedData); `repetition`: 0 for the data themselves.
    ReplayEngine(std::filesystem::path prefix, std::size_t repetition,
                 std::vector<std::string> notes);

    engines::Resources resources(const Case& c, int ranks) const override;
    /// Errors for what a measurement does not contain: depths, stress, volumes, grid studies.
    std::vector<Remark> limits(const Case& c) const override;
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override;

private:
    std::filesystem::path prefix_;
    std::size_t repetition_;
    std::vector<std::string> notes_;
};

} // namespace shearwake::laboratory
