// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/work.hpp"

#include <array>
#include <functional>

namespace shearwake::layered::kinds {

// Unit: one point, time sample and depth; with the spectra in caches or in memory.
inline constexpr engines::WorkKind of_sample = {"layered.sample.cached", 3e-9};
inline constexpr engines::WorkKind of_far_sample = {"layered.sample.memory", 4e-9};
inline constexpr engines::WorkKind of_load = {"layered.load", 6e-9}; // for loads that move in y
// Unit: one point, frame and depth; in caches or in memory.
inline constexpr engines::WorkKind of_frame = {"layered.frame.cached", 4e-9};
inline constexpr engines::WorkKind of_far_frame = {"layered.frame.memory", 4.5e-9};
inline constexpr engines::WorkKind of_response = {"layered.response",
                                                  9e-7}; // per evaluation of H and layer
// Unit: one product of a node of the contour and a radius, see radial_products().
inline constexpr engines::WorkKind of_radial = {"layered.radial", 5e-10};
inline constexpr engines::WorkKind of_expansion = {"layered.expansion",
                                                   2.5e-9}; // per point, time sample and depth
// The same with open edges, where planes are sampled and transformed.
inline constexpr engines::WorkKind of_open_expansion = {"layered.expansion.open", 2e-8};

} // namespace shearwake::layered::kinds

namespace shearwake::layered {

/// Seconds since a fixed time.
using Clock_s = std::function<double()>;
Clock_s steady_clock_s();

/// Reports the share of a case that is complete: elapsed time divided by the sum of elapsed and
/// remaining time. The remaining time of a stage follows from its measured rate, and until the
/// stage has taken a while from the expected one, corrected by the other stages. Without
/// checkpoints it reports nothing.
class CaseProgress {
public:
    enum class Stage { response, radial, expansion, samples, frames };
    static constexpr std::size_t stages = 5;

    explicit CaseProgress(engines::Checkpoints* checkpoints, Clock_s clock = steady_clock_s());

    /// Adds work that the case will do. Not collective.
    void expect(Stage stage, double units, double seconds);
    /// Reports completed work of a stage, to which the time since the last call belongs. Cheap. Not
    /// collective.
    void did(Stage stage, double units = 1.0);
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
