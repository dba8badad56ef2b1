// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/learned_times.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>

namespace shearwake::schedule {
namespace {

/// Largest number of groups. Cases of further kinds are corrected by the ratio of their engine.
constexpr int most_groups = 32;
/// The share of a case after which its remaining time is extrapolated.
constexpr double least_share = 0.01;
/// Reports closer than this are not stored.
constexpr double report_share = 0.001;

} // namespace

Clock_us steady_clock_us() {
    return [] {
        using namespace std::chrono;
        return round<microseconds>(steady_clock::now().time_since_epoch()).count();
    };
}

LearnedTimes::LearnedTimes(std::vector<ExpectedCase> cases, const Comm& world, TeamOf team,
                           Clock_us clock)
    : cases_(std::move(cases)), team_(team), clock_(std::move(clock)), began_(clock_()),
      began_us_(cases_.size(), 0) {
    const auto number_of = [&](const std::string& name, int otherwise) {
        const auto known = numbers_.find(name);
        if (known != numbers_.end()) return known->second;
        if (otherwise >= 0 && group_count_ >= most_groups) return otherwise;
        numbers_[name] = group_count_;
        engine_of_group_.push_back(otherwise < 0 ? group_count_ : otherwise);
        return group_count_++;
    };
    for (const ExpectedCase& c : cases_) {
        engines_.push_back(number_of(c.engine, -1));
        groups_.push_back(number_of(c.engine + ": " + c.kinds, engines_.back()));
    }
    counters_.emplace(world, end_us(team_.teams));
    if (!world.is_root()) return;
    for (std::size_t i = 0; i < cases_.size(); ++i)
        counters_->fetch_add(left_counter(groups_[i]), std::lround(1e6 * cases_[i].estimated_s));
}

void LearnedTimes::add(int number, double seconds, double estimated_s) {
    counters_->fetch_add(group(number).taken, std::lround(1e6 * seconds));
    counters_->fetch_add(group(number).estimated, std::lround(1e6 * estimated_s));
}

void LearnedTimes::load(const storage::JournalContents& journal) {
    for (const auto& [id, history] : journal.cases) {
        const storage::CaseTimes& times = history.times;
        const auto engine = numbers_.find(times.engine);
        if (times.estimated_seconds > 0.0 && engine != numbers_.end())
            add(engine->second, times.seconds, times.estimated_seconds);
    }
}

void LearnedTimes::expect_end(long at_us) {
    counters_->fetch_add(end_us(team_.team), at_us - expected_end_us_);
    expected_end_us_ = at_us;
}

void LearnedTimes::begin(std::size_t index) {
    began_us_[index] = now_us();
    counters_->fetch_add(begun_us(), began_us_[index]);
    counters_->fetch_add(at_work(), 1);
    expect_end(began_us_[index] + std::lround(1e6 * cases_[index].estimated_s * factor(index)));
}

void LearnedTimes::replace(std::size_t index, long taken_us, long estimated_us, long left_us) {
    Partial& p = partial_[index];
    for (const int number : {engines_[index], groups_[index]}) {
        counters_->fetch_add(group(number).taken, taken_us - p.taken_us);
        counters_->fetch_add(group(number).estimated, estimated_us - p.estimated_us);
    }
    counters_->fetch_add(extrapolated_us(), left_us - p.left_us);
    p.taken_us = taken_us;
    p.estimated_us = estimated_us;
    p.left_us = left_us;
}

void LearnedTimes::progressed(std::size_t index, double share) {
    const auto [at, is_first] = partial_.try_emplace(index);
    Partial& p = at->second;
    const Report now{share, now_us()};
    if (!is_first && share < p.recent.back().share) { // the case is repeated
        if (p.counts) replace(index, 0, 0, 0);
        p.first = now;
        p.recent = {now};
        return;
    }
    if (is_first) p.first = now;
    if (is_first || share >= p.recent.back().share + report_share) p.recent.push_back(now);
    const double half = 0.5 * (p.first.share + share);
    while (p.recent.size() > 1 && p.recent[1].share <= half)
        p.recent.pop_front();
    const double passed = share - p.first.share;
    const long taken_us = now.at_us - p.first.at_us;
    if (passed < least_share || taken_us <= 0) return;
    if (!p.counts) { // from its estimate to its progress
        p.counts = true;
        leave_estimates(index);
    }
    const Report& from = p.recent.front();
    const long left_us = std::lround(static_cast<double>(now.at_us - from.at_us) * (1.0 - share) /
                                     (share - from.share));
    replace(index, taken_us, std::lround(1e6 * cases_[index].estimated_s * passed), left_us);
    expect_end(now.at_us + left_us);
}

void LearnedTimes::leave_estimates(std::size_t index) {
    if (began_us_[index] > 0) {
        counters_->fetch_add(at_work(), -1);
        counters_->fetch_add(begun_us(), -began_us_[index]);
    }
    counters_->fetch_add(left_counter(groups_[index]),
                         -std::lround(1e6 * cases_[index].estimated_s));
}

void LearnedTimes::end(std::size_t index) {
    const auto at = partial_.find(index);
    const bool counts = at != partial_.end() && at->second.counts;
    if (counts)
        replace(index, 0, 0, 0);
    else
        leave_estimates(index);
    if (at != partial_.end()) partial_.erase(at);
    expect_end(0);
}

void LearnedTimes::learn(std::size_t index, double seconds, double estimated_s) {
    add(engines_[index], seconds, estimated_s);
    add(groups_[index], seconds, estimated_s);
}

double LearnedTimes::ratio(int number) const {
    const auto estimated = static_cast<double>(counters_->read(group(number).estimated));
    if (!(estimated > 0.0)) return 0.0;
    return static_cast<double>(counters_->read(group(number).taken)) / estimated;
}

double LearnedTimes::ratio_of_case(int number, int engine) const {
    for (const int which : {number, engine})
        if (const double found = ratio(which); found > 0.0) return found;
    return 1.0;
}

double LearnedTimes::factor(std::size_t index) const {
    return ratio_of_case(groups_[index], engines_[index]);
}

double LearnedTimes::left_s() const {
    double left_us = 0.0;
    for (int number = 0; number < group_count_; ++number)
        if (const long us = counters_->read(left_counter(number)); us > 0)
            left_us += static_cast<double>(us) *
                       ratio_of_case(number, engine_of_group_[static_cast<std::size_t>(number)]);
    const auto behind_us =
        static_cast<double>(counters_->read(at_work()) * now_us() - counters_->read(begun_us()));
    const auto extrapolated = static_cast<double>(counters_->read(extrapolated_us()));
    return 1e-6 * (extrapolated + std::max(0.0, left_us - std::max(0.0, behind_us)));
}

double LearnedTimes::wall_left_s(int busy) const {
    double left = left_s() / std::max(1, busy);
    for (int team = 0; team < team_.teams; ++team)
        if (const long end = counters_->read(end_us(team)); end > 0)
            left = std::max(left, 1e-6 * static_cast<double>(end - now_us()));
    return left;
}

} // namespace shearwake::schedule
