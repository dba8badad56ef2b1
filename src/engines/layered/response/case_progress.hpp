// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"

#include <array>

namespace shearwake::layered {

/// The work of the stages of a case on a rank, and the share of it that is complete, which is
/// reported to the checkpoints, if any.
class CaseProgress {
public:
    enum class Stage { response, radial, expansion, setup, samples, frames };

    explicit CaseProgress(engines::Checkpoints* checkpoints) : checkpoints_(checkpoints) {}

    /// Adds work that the case will do: `units` of a stage, which together take about `work_ns` on
    /// a core. Not collective.
    void expect(Stage stage, double units, double work_ns);
    /// The expected work of a stage. Not collective.
    double work_ns(Stage stage) const { return part(stage).work_ns; }
    /// Reports completed units of a stage. Cheap. Not collective.
    void record_completed(Stage stage, double units = 1.0);
    /// Whether a stop was requested, see engines::Checkpoints::stop_asked(). Collective.
    bool stop_asked() { return checkpoints_ && checkpoints_->stop_asked(); }
    /// Throws StopRequested if a stop was requested. Collective.
    void end_if_asked() { engines::end_if_asked(checkpoints_); }

private:
    struct Part {
        double units = 0.0, work_ns = 0.0;
    };
    const Part& part(Stage stage) const { return parts_[static_cast<std::size_t>(stage)]; }

    engines::Checkpoints* checkpoints_;
    std::array<Part, 6> parts_;
    double expected_ns_ = 0.0, done_ns_ = 0.0;
};

} // namespace shearwake::layered
