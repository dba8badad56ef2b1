// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"

#include <array>
#include <functional>

namespace shearwake::layered {

/// Seconds since a fixed time.
using Clock_s = std::function<double()>;
Clock_s steady_clock_s();

/// Reports the share of a case that is complete: elapsed time divided by the sum of elapsed and
/// remaining time. The remaining time of a stage follows from its measured rate, and until the
/// stage has taken a while from the expected one, corrected by the other stages. Also reports the
/// time of the complete stages. Without checkpoints it reports nothing.
class CaseProgress {
public:
    enum class Stage { response, radial, expansion, setup, samples, frames };
    static constexpr std::size_t stages = 6;

    explicit CaseProgress(engines::Checkpoints* checkpoints, Clock_s clock = steady_clock_s());

    /// Adds work that the case will do. Not collective.
    void expect(Stage stage, double units, double seconds);
    /// Reports completed work of a stage, to which the time since the last call belongs. Cheap. Not
    /// collective.
    void did(Stage stage, double units = 1.0);
    /// Reports the time of the stages whose expected work is done; `work`: that of each stage. Not
    /// collective.
    void report_times(const std::array<engines::Work, stages>& work) const;
    /// Whether a stop was requested, see engines::Checkpoints::stop_asked(). Collective.
    bool stop_asked() { return checkpoints_ && checkpoints_->stop_asked(); }
    /// Throws StopRequested if a stop was requested. Collective.
    void end_if_asked() { engines::end_if_asked(checkpoints_); }

private:
    struct Part {
        double units = 0.0, expected_s = 0.0, done = 0.0, measured_s = 0.0;
        bool is_measured() const;
        double left_s(double slowness) const;
    };
    /// Measured time relative to the expected time of the stages whose work is known in advance,
    /// which excludes the evaluations of H.
    double slowness() const;

    engines::Checkpoints* checkpoints_;
    Clock_s clock_;
    double began_s_, last_s_, share_ = 0.0;
    std::array<Part, stages> parts_;
};

} // namespace shearwake::layered
