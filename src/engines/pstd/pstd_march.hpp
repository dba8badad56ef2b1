// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/march.hpp"
#include "engines/pstd/scene/displacements.hpp"
#include "engines/pstd/scheme/recorder.hpp"

#include <memory>
#include <optional>

namespace shearwake::pstd {

/// Runs a scene or a grid study of the engine "pstd": u_z at the measured depths for each frame,
/// displacements for each snapshot, and the samples of a sensor in every step.
template <class Real>
class PstdMarch : public engines::Marching {
public:
    /// Output of the run, set up by the caller on all ranks together.
    struct Outputs {
        Frames frames;
        std::optional<DisplacementVolumes> volumes;
        std::unique_ptr<Recorder> sensor;
    };
    /// Stores references, which must outlive this object. `displacement` is the name of u_z in
    /// checkpoints. Not collective.
    PstdMarch(const Case& c, std::ptrdiff_t steps_per_frame, Stepper<Real>& stepper,
              Outputs& outputs, std::string displacement, const Comm& team)
        : case_(c), per_frame_(steps_per_frame), stepper_(stepper), outputs_(outputs),
          displacement_(std::move(displacement)), team_(team), watch_(energy_watch()) {}

    std::ptrdiff_t step() const override { return stepper_.steps(); }
    void advance() override;
    void emit(engines::Observer& observer) override;
    void save(StateWriter& state) const override;
    void restore(const StateReader& state) override;

private:
    engines::EnergyWatch energy_watch() const;
    void watch();

    const Case& case_;
    std::ptrdiff_t per_frame_;
    Stepper<Real>& stepper_;
    Outputs& outputs_;
    std::string displacement_;
    Comm team_;
    engines::EnergyWatch watch_;
    double watched_work_J_ = 0.0; // the part of stepper_.work_J() that watch_ has
};

} // namespace shearwake::pstd
