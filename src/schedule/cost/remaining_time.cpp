// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/remaining_time.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace shearwake::schedule {
namespace {

/// Cases of further kinds share the ratio of the last one.
constexpr int most_kinds = 64;
/// The share of a case after which its remaining time is extrapolated.
constexpr double least_share = 0.01;

} // namespace

Clock_us steady_clock_us() {
    return [] {
        using namespace std::chrono;
        return round<microseconds>(steady_clock::now().time_since_epoch()).count();
    };
}

RemainingTime::RemainingTime(std::vector<ExpectedCase> cases, const Comm& world, TeamOf team,
                             Clock_us clock)
    : cases_(std::move(cases)), team_(team), clock_(std::move(clock)), began_(clock_()),
      has_begun_(cases_.size(), false) {
    std::map<std::string, int> numbers;
    for (const ExpectedCase& c : cases_)
        kinds_.push_back(
            numbers.try_emplace(c.kind, std::min(static_cast<int>(numbers.size()), most_kinds - 1))
                .first->second);
    kind_count_ = std::min(static_cast<int>(numbers.size()), most_kinds);
    counters_.emplace(world, end_us(team_.teams));
    if (!world.is_root()) return;
    for (std::size_t i = 0; i < cases_.size(); ++i)
        counters_->fetch_add(counter(kinds_[i], left), estimated_us(i));
}

long RemainingTime::estimated_us(std::size_t index) const {
    return std::lround(1e6 * cases_[index].estimated_s);
}

void RemainingTime::expect_end(long at_us) {
    counters_->fetch_add(end_us(team_.team), at_us - expected_end_us_);
    expected_end_us_ = at_us;
}

void RemainingTime::begin(std::size_t index) {
    has_begun_[index] = true;
    first_.reset();
    counters_->fetch_add(counter(kinds_[index], left), -estimated_us(index));
    expect_end(now_us() + std::lround(static_cast<double>(estimated_us(index)) * factor(index)));
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
    if (!has_begun_[index])
        counters_->fetch_add(counter(kinds_[index], left), -estimated_us(index));
    has_begun_[index] = true;
    first_.reset();
    expect_end(0);
}

void RemainingTime::learn(std::size_t index, double seconds) {
    counters_->fetch_add(counter(kinds_[index], taken), std::lround(1e6 * seconds));
    counters_->fetch_add(counter(kinds_[index], estimated), estimated_us(index));
}

double RemainingTime::ratio(int kind) const {
    const auto us = static_cast<double>(counters_->read(counter(kind, estimated)));
    if (!(us > 0.0)) return 1.0;
    return static_cast<double>(counters_->read(counter(kind, taken))) / us;
}

double RemainingTime::wall_left_s(int busy) const {
    double left_us = 0.0, longest_us = 0.0;
    for (int kind = 0; kind < kind_count_; ++kind)
        left_us +=
            std::max(0.0, static_cast<double>(counters_->read(counter(kind, left)))) * ratio(kind);
    for (int team = 0; team < team_.teams; ++team)
        if (const long end = counters_->read(end_us(team)); end > 0) {
            const double running_us = std::max(0.0, static_cast<double>(end - now_us()));
            left_us += running_us;
            longest_us = std::max(longest_us, running_us);
        }
    return 1e-6 * std::max(longest_us, left_us / std::max(1, busy));
}

} // namespace shearwake::schedule
