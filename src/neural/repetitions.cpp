// SPDX-License-Identifier: BSD-3-Clause
#include "neural/repetitions.hpp"

#include "neural/fibre/neuron.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::neural {
namespace {

constexpr double time_constants = 8.0;
constexpr double travel_s = 50e-3; // 400 mm at 8 m/s, twice the length of the hand
constexpr double run_out_s = 10e-3;

/// The number of periods that last at least this time, and at least one.
std::size_t periods_within(double time_s, double period_s) {
    return static_cast<std::size_t>(std::max(std::ceil(time_s / period_s - 1e-9), 1.0));
}

} // namespace

double run_in_s(std::span<const Afferent> afferents) {
    double slowest_samples = 0.0;
    for (const Afferent& one : afferents)
        slowest_samples =
            std::max(slowest_samples, neuron_rows(one.kind)[one.row].membrane_samples);
    const double samples =
        time_constants * slowest_samples + static_cast<double>(after_spike_samples);
    return travel_s + samples / neuron_rate_Hz;
}

Repetitions repetitions_of(std::span<const Afferent> afferents, double period_s,
                           std::size_t counted) {
    return {.run_in = periods_within(run_in_s(afferents), period_s),
            .counted = counted,
            .run_out = periods_within(run_out_s, period_s)};
}

Lines repeated(const Lines& lines, std::size_t times) {
    Lines out(lines.count, times * lines.samples);
    for (std::size_t i = 0; i < lines.count; ++i) {
        auto to = out.line(i).begin();
        for (std::size_t repetition = 0; repetition < times; ++repetition)
            to = std::ranges::copy(lines.line(i), to).out;
    }
    return out;
}

} // namespace shearwake::neural
