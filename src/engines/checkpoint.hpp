// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/state.hpp"

#include <functional>
#include <string>

namespace shearwake::engines {

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
    virtual bool stop_asked() = 0;
    /// Reports the share of the steps that are complete, 0 to 1, after every step. Cheap. Not
    /// collective.
    virtual void progressed(double share) = 0;
};

/// Ends the computation of a case after stop_asked(). Thrown on all ranks of a team together and
/// caught by the engine.
struct StopRequested {};

/// Throws StopRequested if a stop was requested. Collective, see Checkpoints::stop_asked().
inline void end_if_asked(Checkpoints* checkpoints) {
    if (checkpoints && checkpoints->stop_asked()) throw StopRequested{};
}

} // namespace shearwake::engines
