// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/state.hpp"

#include <functional>
#include <string>

namespace shearwake::engines {

/// A part of the computation of a case, whose time is `size` times `count` times a rate that runs
/// measure (schedule/cost/rates.hpp).
struct Work {
    /// Parts of the same kind and of a similar size take equally long per unit. A '#' begins the
    /// hash of what the time depends on in a way that only a measurement shows, such as bodies.
    std::string kind;
    double size = 0.0;      // unknowns of all ranks
    double count = 1.0;     // how often they are computed, such as the number of steps
    bool is_shared = false; // done once per medium and grid
    double amount() const { return size * count; }
};

/// A part of a computation and the seconds that it has taken on a team.
struct TimedWork {
    Work work;
    double seconds = 0.0;
};

/// Decides when to save and stores the checkpoints of a case. Collective.
class Checkpoints {
public:
    virtual ~Checkpoints() = default;
    /// Whether to save now. Called after every step but the last. Returns the same value on all
    /// ranks.
    virtual bool due() = 0;
    /// Writes a checkpoint. A failure to write (for example a full disk) is reported and does not
    /// end the case.
    virtual void save(const std::function<void(StateWriter&)>& write) = 0;
    /// Passes the newest complete checkpoint that belongs to this case and program version to
    /// `read`. Returns false, without calling `read`, if there is none.
    virtual bool restore(const std::function<void(const StateReader&)>& read) = 0;
    /// Whether the engine should return because a stop was requested: after a save, or after
    /// stop_asked().
    virtual bool stop() const = 0;
    /// Whether a stop was requested and the time for completing the case has expired, for engines
    /// that save nothing. Call it equally often on all ranks, as often as convenient: the ranks
    /// communicate about every 0.1 s. Returns the same value on all ranks.
    virtual bool stop_asked() { return false; }
    /// Reports the share of the steps that are complete, 0 to 1, after every step. Cheap. Not
    /// collective.
    virtual void progressed(double /*share*/) {}
    /// Reports the time of a part of the computation when it ends, also if the run is stopped. Not
    /// collective.
    virtual void timed(const TimedWork& /*part*/) {}
};

/// Ends the computation of a case after stop_asked(). Thrown on all ranks of a team together and
/// caught by the engine.
struct StopRequested {};

/// Throws StopRequested if a stop was requested. Collective, see Checkpoints::stop_asked().
inline void end_if_asked(Checkpoints* checkpoints) {
    if (checkpoints && checkpoints->stop_asked()) throw StopRequested{};
}

} // namespace shearwake::engines
