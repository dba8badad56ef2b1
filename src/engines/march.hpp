// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/checkpoint.hpp"
#include "engines/engine.hpp"
#include "parallel/comm.hpp"
#include "parallel/state.hpp"

#include <cstddef>
#include <optional>
#include <string>

namespace shearwake::engines {

/// Checks that the kinetic energy of a field does not exceed what its sources have supplied. A time
/// step preserves a discrete energy E, apart from the work of the load and from losses. E itself
/// does not reveal an instability, in which it is the difference of two growing quantities.
/// However, E is at least 1/`most_1` of the kinetic energy where the scheme is stable. Therefore
/// the kinetic energy of a stable field never exceeds `most_1` times the work, and is usually
/// smaller than the work.
class EnergyWatch {
public:
    struct Limits {
        double most_1 = 1.0;          // kinetic energy relative to the supplied energy
        std::ptrdiff_t interval = 16; // number of steps between two checks
        std::string advice;           // what may help, at the end of the messages
    };
    EnergyWatch(const Comm& team, double step_s, Limits limits)
        : team_(team), step_s_(step_s), limits_(std::move(limits)) {}

    /// Whether the field is checked at this step. Not collective.
    bool due(std::ptrdiff_t step) const { return step % limits_.interval == 0; }
    /// Checks the field at a step. `kinetic_J_m2` is this rank's part of the kinetic energy per
    /// area. Throws FieldDiverges on all ranks together. Collective.
    void check(std::ptrdiff_t step, double kinetic_J_m2);

    /// Adds this rank's part of the work per area of the load. Not collective.
    void add_work(double work_J_m2) { work_J_m2_ += work_J_m2; }
    /// Total work per area of all ranks. Collective.
    double work_J_m2() const { return team_.sum(work_J_m2_); }

    /// Save and restore the supplied energy. Collective.
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

private:
    [[noreturn]] void not_finite(std::ptrdiff_t step) const;
    double time_ms(std::ptrdiff_t step) const { return 1e3 * static_cast<double>(step) * step_s_; }

    Comm team_;
    double step_s_;
    Limits limits_;
    double work_J_m2_ = 0.0; // this rank's part
    double most_J_m2_ = 0.0; // maximum work of all ranks at the checked steps
};

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
    virtual void emit(Observer& observer) = 0;
    /// Save and restore everything that changes from step to step. Collective.
    virtual void save(StateWriter& state) const = 0;
    virtual void restore(const StateReader& state) = 0;
};

enum class MarchEnd { complete, stopped };

/// Advances the field to step `steps`, starting from the newest checkpoint if there is one. The
/// caller has already called Observer::begin. Saves the field and the observer whenever a
/// checkpoint is due, and returns after a save if a stop was requested. All time-stepping engines
/// use this loop. Throws what Marching::advance throws. Collective.
MarchEnd march(Marching& field, std::ptrdiff_t steps, Observer& observer, Checkpoints* checkpoints);

/// The index (into RecordOptions::volumes_s) of the snapshot at the end of an output interval,
/// counted from 1, if any. Not collective.
std::optional<std::size_t> snapshot_at(const Case& c, std::ptrdiff_t interval);

} // namespace shearwake::engines
