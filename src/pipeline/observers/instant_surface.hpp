// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/mach_angle.hpp"
#include "pipeline/observers/recording.hpp"

#include <optional>

namespace shearwake::pipeline {

/// Stores the surface at the instant `measure.at` and fits the angle of the wake to it.
class InstantSurface : public Recording {
public:
    InstantSurface(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// On rank 0 only; empty elsewhere.
    const std::optional<measures::MachFit>& mach() const { return mach_; }

private:
    measures::MachFit fit(const std::vector<double>& surface) const;

    const Case& case_;
    const Comm& team_;
    engines::Slab slab_;
    std::ptrdiff_t instant_;
    std::vector<double> rows_;
    bool is_held_ =
        false; // the frame of the instant was received; this rank may have no rows of it
    std::optional<measures::MachFit> mach_;
};

} // namespace shearwake::pipeline
