// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::engines {

void EnergyWatch::not_finite(std::ptrdiff_t step) const {
    throw FieldDiverges(fmt::format("step {} at {:.4g} ms: the field is not finite; {}", step,
                                    time_ms(step), limits_.advice));
}

void EnergyWatch::check(std::ptrdiff_t step, double kinetic_J_m2) {
    double sums[2] = {kinetic_J_m2, work_J_m2_};
    team_.sum(std::span<double>(sums));
    // Checked first, because comparisons with NaN are false.
    if (!std::isfinite(sums[0]) || !std::isfinite(sums[1])) not_finite(step);
    most_J_m2_ = std::max(most_J_m2_, sums[1]);
    if (sums[0] > limits_.most_1 * most_J_m2_)
        throw FieldDiverges(fmt::format(
            "step {} at {:.4g} ms: the field diverges: its kinetic energy is {:.3g} J/m2, but the "
            "total work of the load is only {:.3g} J/m2; {}",
            step, time_ms(step), sums[0], most_J_m2_, limits_.advice));
}

void EnergyWatch::save(StateWriter& state) const {
    state.put("work_J_m2", work_J_m2());
    state.put("most_work_J_m2", most_J_m2_);
}

void EnergyWatch::restore(const StateReader& state) {
    const double work_J_m2 = state.get("work_J_m2");
    work_J_m2_ = team_.is_root() ? work_J_m2 : 0.0;
    most_J_m2_ = state.get("most_work_J_m2");
}

MarchEnd march(Marching& field, std::ptrdiff_t steps, Observer& observer,
               Checkpoints* checkpoints) {
    if (checkpoints)
        checkpoints->restore([&](const StateReader& state) {
            field.restore(state);
            observer.restore(state);
        });
    const auto report = [&] {
        if (checkpoints)
            checkpoints->progressed(static_cast<double>(field.step()) / static_cast<double>(steps));
    };
    report();
    while (field.step() < steps) {
        field.advance();
        report();
        field.emit(observer);
        if (!checkpoints || field.step() == steps || !checkpoints->due()) continue;
        checkpoints->save([&](StateWriter& state) {
            field.save(state);
            observer.save(state);
        });
        if (checkpoints->stop()) return MarchEnd::stopped;
    }
    return MarchEnd::complete;
}

std::optional<std::size_t> snapshot_at(const Case& c, std::ptrdiff_t interval) {
    for (std::size_t i = 0; i < c.record.volumes_s.size(); ++i)
        if (std::llround(c.record.volumes_s[i] / c.time.interval_s) == interval) return i;
    return {};
}

} // namespace shearwake::engines
