// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/clock.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake {

/// A question that only the root of a team can answer and that all ranks ask in a loop. They
/// communicate about once per interval, since ranks that share cores lose milliseconds at every
/// synchronisation.
class SpacedQuestion {
public:
    /// Not collective.
    SpacedQuestion(const Comm& team, double interval_s);
    /// The root's answer, on all ranks; false between two intervals, without communication.
    /// `answer` is called on the root only. Call it equally often on all ranks. Collective.
    bool ask(const std::function<bool()>& answer);

private:
    const Comm& team_;
    double interval_s_;
    long asked_ = 0, last_ = 0, next_ = 1; // numbers of calls; the ranks communicate in call next_
    Clock::time_point last_at_;
};

} // namespace shearwake
