// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/remaining_time.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace shearwake::schedule {
namespace {

/// The share of a case after which its remaining time is extrapolated.
constexpr double least_share = 0.01;

} // namespace

Clock_us steady_clock_us() {
    return [] {
        using namespace std::chrono;
        return round<microseconds>(steady_clock::now().time_since_epoch()).count();
    };
}

RemainingTime::RemainingTime(std::vector<double> estimated_s, const Comm& world, TeamOf team,
                             Clock_us clock)
    : estimated_s_(std::move(estimated_s)), team_(team), clock_(std::move(clock)), began_(clock_()),
      has_begun_(estimated_s_.size(), false) {
    counters_.emplace(world, end_us(team_.teams));
    if (!world.is_root()) return;
    for (std::size_t i = 0; i < estimated_s_.size(); ++i)
        counters_->fetch_add(left, estimated_us(i));
}

long RemainingTime::estimated_us(std::size_t index) const {
    return std::lround(1e6 * estimated_s_[index]);
}

void RemainingTime::expect_end(long at_us) {
    counters_->fetch_add(end_us(team_.team), at_us - expected_end_us_);
    expected_end_us_ = at_us;
}

void RemainingTime::begin(std::size_t index) {
    has_begun_[index] = true;
    first_.reset();
    counters_->fetch_add(left, -estimated_us(index));
    expect_end(now_us() + std::lround(static_cast<double>(estimated_us(index)) * ratio()));
}

void RemainingTime::progressed(double share) {
    const long now = now_us();
    if (!first_ || share < first_->share) first_ = {share, now};
    const double passed = share - first_->share;
    if (passed < least_share) return;
    expect_end(now +
               std::lround(static_cast<double>(now - first_->at_us) * (1.0 - share) / passed));
}

void RemainingTime::end(std::size_t index) {
    if (!has_begun_[index]) counters_->fetch_add(left, -estimated_us(index));
    has_begun_[index] = true;
    first_.reset();
    expect_end(0);
}

void RemainingTime::learn(std::size_t index, double seconds) {
    counters_->fetch_add(taken, std::lround(1e6 * seconds));
    counters_->fetch_add(estimated, estimated_us(index));
}

double RemainingTime::ratio() const {
    const auto us = static_cast<double>(counters_->read(estimated));
    return us > 0.0 ? static_cast<double>(counters_->read(taken)) / us : 1.0;
}

double RemainingTime::wall_left_s(int busy) const {
    double left_us = std::max(0.0, static_cast<double>(counters_->read(left))) * ratio(),
           longest_us = 0.0;
    for (int team = 0; team < team_.teams; ++team)
        if (const long end = counters_->read(end_us(team)); end > 0) {
            const double running_us = std::max(0.0, static_cast<double>(end - now_us()));
            left_us += running_us;
            longest_us = std::max(longest_us, running_us);
        }
    return 1e-6 * std::max(longest_us, left_us / std::max(1, busy));
}

} // namespace shearwake::schedule
