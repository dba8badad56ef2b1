// SPDX-License-Identifier: BSD-3-Clause
#include "engines/march.hpp"

#include <cmath>

namespace shearwake::engines {
namespace {

/// Notices whether planes of a snapshot are passed on.
class SnapshotWatch : public ForwardingObserver {
public:
    using ForwardingObserver::ForwardingObserver;
    void volume(const VolumePlane& plane) override {
        has_snapshot = true;
        ForwardingObserver::volume(plane);
    }
    bool has_snapshot = false;
};

} // namespace

std::vector<Work> parts_of(const MarchWork& work) {
    std::vector<Work> parts = {{work.kind + ", setup", work.unknowns, 1.0},
                               {work.kind + ", steps", work.unknowns, work.steps - 1.0}};
    if (work.snapshots > 0.0)
        parts.push_back({work.kind + ", volumes", work.values, work.snapshots});
    return parts;
}

MarchEnd march(Marching& field, std::ptrdiff_t steps, Observer& observer, Checkpoints* checkpoints,
               const MarchWork& work, Clock::time_point began) {
    const bool is_resumed = checkpoints && checkpoints->restore([&](const StateReader& state) {
        field.restore(state);
        observer.restore(state);
    });
    const auto report = [&] {
        if (checkpoints)
            checkpoints->progressed(static_cast<double>(field.step()) / static_cast<double>(steps));
    };
    report();
    SnapshotWatch watched(observer);
    struct Part {
        double seconds = 0.0, count = 0.0;
    };
    Part setup, each, snapshots; // the first step, which touches cold memory, is part of the setup
    const auto advance = [&] {
        const auto from = Clock::now();
        field.advance();
        report();
        const auto between = Clock::now();
        watched.has_snapshot = false;
        field.give(watched);
        const auto to = Clock::now();
        const bool is_first = setup.count == 0.0;
        Part& output = watched.has_snapshot ? snapshots : is_first ? setup : each;
        output.seconds += seconds_between(between, to);
        if (watched.has_snapshot) snapshots.count += 1.0;
        if (is_first)
            setup = {setup.seconds + seconds_between(began, between), 1.0};
        else
            each = {each.seconds + seconds_between(from, between), each.count + 1.0};
    };
    const auto end = [&](MarchEnd how) {
        if (!checkpoints) return how;
        const std::vector<Work> parts = parts_of(work);
        const Part found[] = {is_resumed ? Part{} : setup, each, snapshots};
        for (std::size_t i = 0; i < parts.size(); ++i)
            if (found[i].count > 0.0)
                checkpoints->timed(
                    {{parts[i].kind, parts[i].size, found[i].count}, found[i].seconds});
        return how;
    };
    while (field.step() < steps) {
        advance();
        if (!checkpoints || field.step() == steps || !checkpoints->due()) continue;
        checkpoints->save([&](StateWriter& state) {
            field.save(state);
            observer.save(state);
        });
        if (checkpoints->stop()) return end(MarchEnd::stopped);
    }
    return end(MarchEnd::complete);
}

std::optional<std::size_t> snapshot_at(const Case& c, std::ptrdiff_t interval) {
    for (std::size_t i = 0; i < c.record.volumes_s.size(); ++i)
        if (std::llround(c.record.volumes_s[i] / c.time.interval_s) == interval) return i;
    return {};
}

} // namespace shearwake::engines
