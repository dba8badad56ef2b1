// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/run/run_state.hpp"

#include <chrono>
#include <cmath>
#include <numeric>

namespace shearwake::schedule {

using namespace std::chrono_literals;

RunState::RunState(const WorkList& list, const Comm& world, Progress& progress)
    : list_(list), world_(world), progress_(progress), counters_(world, counter_count) {
    const double total_work = std::accumulate(list_.work.work.begin(), list_.work.work.end(), 0.0);
    if (world.is_root()) add(work_left, std::lround(total_work));
}

void RunState::count_work(std::size_t place, double share) {
    const long work = std::lround(share * list_.work.work[place]);
    const long more = work - counted_work_.value_or(0);
    if (counted_work_) add(work_done, more);
    add(work_left, -more);
    counted_work_ = work;
}

void RunState::end_case(std::size_t place, CaseEnd end) {
    if (end == CaseEnd::complete && counted_work_) count_work(place, 1.0);
    const long counted_before = counted_work_.value_or(0);
    counted_work_.reset();
    if (end == CaseEnd::deferred)
        add(work_left, counted_before);
    else
        add(work_left, counted_before - std::lround(list_.work.work[place]));
}

void RunState::show_share(double share) {
    const long ppm = std::lround(1e6 * share);
    add(partial_ppm, ppm - partial_ppm_);
    partial_ppm_ = ppm;
    tick();
}

std::optional<double> RunState::pace_s() {
    const auto work = static_cast<double>(read(work_done));
    if (!(work > 0.0)) return std::nullopt;
    return seconds_since(began_) * list_.work.layout.teams / work;
}

bool RunState::stop_asked() {
    const auto now = Clock::now();
    bool is_asked = stop_requested() || list_.deadline.left_s() <= 0.0;
    if (world_.is_root() && now - last_stop_file_ > 500ms) {
        last_stop_file_ = now;
        std::error_code ignored;
        is_asked = is_asked || std::filesystem::exists(list_.folder.stop_file(), ignored);
    }
    if (is_asked && !signal_reported_) {
        signal_reported_ = true;
        add(signalled);
    }
    if (!signal_seen_ && now - last_look_ > 50ms) {
        last_look_ = now;
        signal_seen_ = read(signalled) > 0;
    }
    return signal_reported_ || signal_seen_;
}

void RunState::give_up() {
    add(given_up);
    add(stopping);
}

/// A folder that is removed while files are written keeps some of them: only a missing plan shows
/// this.
void RunState::look_for_folder(Look when) {
    const auto now = Clock::now();
    if (when == Look::soon && now - last_folder_ < 500ms) return;
    last_folder_ = now;
    if (!list_.folder.has_lost_plan()) return;
    add(folder_removed);
    give_up();
}

void RunState::tick() {
    if (!world_.is_root()) return;
    const auto now = Clock::now();
    if (now - last_tick_ < 50ms) return;
    last_tick_ = now;
    stop_asked(); // looks for the STOP file on behalf of the other teams
    SweepCounts counts{.total = static_cast<long>(list_.work.cases.size()) - read(elsewhere),
                       .done = read(done),
                       .failed = read(failed)};
    counts.running = read(begun) - counts.done - counts.failed;
    const auto work = static_cast<double>(read(work_done));
    counts.left_s =
        time_left_s(seconds_since(began_), work, work + static_cast<double>(read(work_left)));
    counts.partial = 1e-6 * static_cast<double>(read(partial_ppm));
    progress_.update(counts);
}

void RunState::last_tick() {
    last_tick_ = {};
    tick();
}

} // namespace shearwake::schedule
