// SPDX-License-Identifier: BSD-3-Clause
#include "base/work_clock.hpp"

#include <algorithm>
#include <iterator>

namespace shearwake {

WorkClock::WorkClock() : last_(Clock::now()) {
    listening_ = this;
}

WorkClock::~WorkClock() {
    listening_ = nullptr;
}

double WorkClock::seconds(std::string_view stage) {
    switch_to(current_);
    const auto found = std::ranges::find(stages_, stage, &Stage::name);
    return found == stages_.end() ? 0.0 : found->seconds;
}

std::size_t WorkClock::enter(std::string_view stage) {
    const auto found = std::ranges::find(stages_, stage, &Stage::name);
    const auto at = static_cast<std::size_t>(found - stages_.begin());
    if (found == stages_.end()) stages_.push_back({stage});
    const std::size_t outer = current_;
    switch_to(at);
    return outer;
}

void WorkClock::switch_to(std::size_t stage) {
    const auto now = Clock::now();
    stages_[current_].seconds += seconds_between(last_, now);
    current_ = stage;
    last_ = now;
}

} // namespace shearwake
