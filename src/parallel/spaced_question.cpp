// SPDX-License-Identifier: BSD-3-Clause
#include "parallel/spaced_question.hpp"

#include "base/clock.hpp"

#include <algorithm>

namespace shearwake {

SpacedQuestion::SpacedQuestion(const Comm& team, double interval_s)
    : team_(team), interval_s_(interval_s), last_at_(Clock::now()) {}

bool SpacedQuestion::ask(const std::function<bool()>& answer) {
    if (++asked_ < next_) return false;
    bool found = false;
    long wait = 0;
    if (team_.is_root()) {
        found = answer();
        // The calls may become slower: the number of calls to the next question at most doubles.
        const auto calls = static_cast<double>(std::max(1L, asked_ - last_));
        const double since_s = seconds_since(last_at_);
        const double call_s = std::max(since_s, 1e-9) / calls;
        wait = static_cast<long>(std::clamp(interval_s_ / call_s, 1.0, 2.0 * calls));
    }
    found = team_.broadcast(found);
    last_ = asked_;
    next_ = asked_ + team_.broadcast(wait);
    last_at_ = Clock::now();
    return found;
}

} // namespace shearwake
