// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/checkpoint.hpp"
#include "engines/engine.hpp"

#include <optional>

namespace shearwake::engines {

/// A field that is advanced step by step and passes its output to an observer.
class Marching {
public:
    virtual ~Marching() = default;
    /// Number of completed steps, including those before a restore. Not collective.
    virtual std::ptrdiff_t step() const = 0;
    /// Advances by one step. Throws FieldDiverges on all ranks together. Collective.
    virtual void advance() = 0;
    /// Passes the frame, snapshot or sample at the end of the last step, if any, to the observer.
    /// Collective.
    virtual void give(Observer& observer) = 0;
    /// Save and restore everything that changes from step to step. Collective.
    virtual void save(StateWriter& state) const = 0;
    virtual void restore(const StateReader& state) = 0;
};

/// The work of a march, whose time it measures.
struct MarchWork {
    std::string kind;      // see Work::kind
    double unknowns = 0.0; // of all ranks, with the values that a step passes on
    double steps = 0.0;
    double values = 0.0; // of a snapshot
    double snapshots = 0.0;
};
/// Its parts: the setup with the first step, the other steps and the snapshots. Not collective.
std::vector<Work> parts_of(const MarchWork& work);

enum class MarchEnd { complete, stopped };

/// Advances the field to step `steps`, starting from the newest checkpoint if there is one. The
/// caller has already called Observer::begin. Saves the field and the observer whenever a
/// checkpoint is due, and returns after a save if a stop was requested. All time-stepping engines
/// use this loop. Reports the seconds of the parts of `work` to the checkpoints; the setup has
/// begun at `began` and ends with the first step. Throws what Marching::advance throws. Collective.
MarchEnd march(Marching& field, std::ptrdiff_t steps, Observer& observer, Checkpoints* checkpoints,
               const MarchWork& work, Clock::time_point began);

/// The index (into RecordOptions::volumes_s) of the snapshot at the end of an output interval,
/// counted from 1, if any. Not collective.
std::optional<std::size_t> snapshot_at(const Case& c, std::ptrdiff_t interval);

} // namespace shearwake::engines
