// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/recording.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::pipeline {

std::ptrdiff_t frame_at(const Case& c, double t_s) {
    return std::clamp<std::ptrdiff_t>(std::llround(t_s / c.time.interval_s) - 1, 0,
                                      c.time.frames - 1);
}

void RankParts::save_ranks(StateWriter& state) const {
    state.put("recorder_ranks", team_.size());
}

void RankParts::save(StateWriter& state, const std::string& name,
                     const std::vector<double>& mine) const {
    state.put(name, {team_.size(), team_.rank(), 1, static_cast<std::ptrdiff_t>(mine.size())},
              mine.data());
}

void RankParts::restore(const StateReader& state, const std::string& name, std::size_t length,
                        const std::function<void(std::span<const double>)>& take) const {
    const auto parts = static_cast<std::ptrdiff_t>(std::lround(state.get("recorder_ranks")));
    const std::ptrdiff_t first = parts * team_.rank() / team_.size();
    const std::ptrdiff_t count = parts * (team_.rank() + 1) / team_.size() - first;
    std::vector<double> mine;
    together(team_, [&] { mine.resize(static_cast<std::size_t>(count) * length); });
    state.get(name, {parts, first, count, static_cast<std::ptrdiff_t>(length)}, mine.data());
    for (std::size_t at = 0; at < mine.size(); at += length)
        take(std::span(mine).subspan(at, length));
}

} // namespace shearwake::pipeline
