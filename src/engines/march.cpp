// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"

#include <cmath>

namespace shearwake::engines {

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
        field.give(observer);
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
