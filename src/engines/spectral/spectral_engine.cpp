#include "engines/spectral/spectral_engine.hpp"

#include "base/error.hpp"
#include "engines/spectral/choices.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "engines/spectral/spectral_estimate.hpp"
#include "engines/spectral/tensor_volumes.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

namespace shearwake {
namespace {

std::vector<double> levels_of(const DepthMesh& mesh) {
    std::vector<double> z_m;
    for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
        z_m.push_back(mesh.z_m(level));
    return z_m;
}

/// Collective.
SolverReport report_of(Stepper& stepper, std::vector<std::string> notes) {
    notes.insert(notes.end(), stepper.notes().begin(), stepper.notes().end());
    const StepStatistics& s = stepper.statistics();
    const EnergyBalance balance = stepper.energy(); // the last look at a field that diverges
    return {std::move(notes),  s.steps,        s.iterations,
            s.most_iterations, balance.work_J, balance.energy_J};
}

} // namespace

Estimate SpectralEngine::estimate(const Case& c, int ranks) const {
    const auto& options = std::get<SpectralOptions>(c.solver);
    const TimeStep time = choose_time_step(c, options);
    return estimate_spectral(c, choose_mesh(c, options, time.step_s), time.per_frame, ranks);
}

std::vector<std::string> SpectralEngine::choices(const Case& c) const {
    const auto& options = std::get<SpectralOptions>(c.solver);
    const TimeStep time = choose_time_step(c, options);
    auto notes = discretisation_notes(time, choose_mesh(c, options, time.step_s));
    for (const auto& more : {edge_notes(c), variation_notes(c, options)})
        notes.insert(notes.end(), more.begin(), more.end());
    return notes;
}

void SpectralEngine::run(const Case& c, const Comm& team, Observer& observer,
                         Checkpoints* checkpoints) {
    const auto& options = std::get<SpectralOptions>(c.solver);
    const TimeStep time = choose_time_step(c, options);
    const std::ptrdiff_t per_frame = time.per_frame;
    const DepthMesh mesh = choose_mesh(c, options, time.step_s);
    const SlabTransform slabs(c.domain.nx, c.domain.ny, team, Planning::measured);
    const SlabShare& share = slabs.share();
    Stepper stepper(c, mesh, slabs, time.step_s, team);
    TensorVolumes tensors(c, mesh, slabs, time.step_s, team);
    ReceptorStress receptors(c, mesh, slabs, time.step_s, team);
    AlignedVector<double> plane;
    together(team, [&] { plane.resize(static_cast<std::size_t>(share.reals)); });
    observer.begin({share.x_start, share.x_count});
    const std::vector<double> levels_m = levels_of(mesh);
    if (!c.record.volumes_s.empty()) observer.volume_levels(levels_m);
    if (checkpoints)
        checkpoints->restore([&](StateReader& state) {
            stepper.restore(state);
            observer.restore(state);
        });
    const auto give_frame = [&](std::ptrdiff_t number) {
        for (std::size_t depth = 0; depth < c.measure.depths_m.size(); ++depth) {
            stepper.plane_of_w(c.measure.depths_m[depth], plane.data());
            slabs.to_physical(plane.data());
            observer.frame({.number = number,
                            .depth = depth,
                            .u_z_m = View2<const double>(plane.data(), share.x_count, c.domain.ny,
                                                         share.padded_ny)});
        }
    };
    // The snapshot that a step ends at, if any.
    const auto snapshot_at = [&](std::ptrdiff_t step) -> std::optional<std::size_t> {
        for (std::size_t i = 0; i < c.record.volumes_s.size(); ++i)
            if (std::llround(c.record.volumes_s[i] / c.time.interval_s) * per_frame == step)
                return i;
        return {};
    };
    const auto& kept = c.record.volume_fields;
    const auto field_u = std::find(kept.begin(), kept.end(), VolumeField::u);
    const auto give_u = [&](std::size_t snapshot) {
        if (field_u == kept.end()) return;
        for (std::size_t component = 0; component < 3; ++component) {
            for (std::size_t level = 0; level < levels_m.size(); ++level) {
                stepper.plane_of_u(component, level, plane.data());
                slabs.to_physical(plane.data());
                observer.volume({.snapshot = snapshot,
                                 .field = static_cast<std::size_t>(field_u - kept.begin()),
                                 .component = component,
                                 .level = level,
                                 .values = View2<const double>(plane.data(), share.x_count,
                                                               c.domain.ny, share.padded_ny)});
            }
        }
    };
    const std::ptrdiff_t steps = c.time.frames * per_frame;
    // One step; strain and stress of a snapshot or frame where it began need it as well.
    const auto advance = [&] {
        const std::ptrdiff_t began = stepper.step();
        const auto snapshot = tensors.wanted() ? snapshot_at(began) : std::nullopt;
        const bool felt = receptors.wanted() && began > 0 && began % per_frame == 0;
        if (snapshot) tensors.remember(stepper);
        if (felt) receptors.remember(stepper);
        stepper.advance();
        if (snapshot) tensors.give(stepper, *snapshot, observer);
        if (felt) receptors.give(stepper, began / per_frame - 1, observer);
    };
    while (stepper.step() < steps) {
        advance();
        if (stepper.step() % per_frame == 0) give_frame(stepper.step() / per_frame - 1);
        if (const auto snapshot = snapshot_at(stepper.step())) give_u(*snapshot);
        if (!checkpoints || stepper.step() == steps || !checkpoints->due()) continue;
        checkpoints->save([&](StateWriter& state) {
            stepper.save(state);
            observer.save(state);
        });
        if (checkpoints->stop()) return;
    }
    auto notes = discretisation_notes(time, mesh);
    for (std::string& note : edge_notes(c))
        notes.push_back(std::move(note));
    const SolverReport report = report_of(stepper, std::move(notes));
    if ((tensors.wanted() && snapshot_at(steps)) || receptors.wanted()) advance();
    observer.solved(report);
}

} // namespace shearwake
