// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/spectral_march.hpp"

#include "parallel/agree.hpp"

#include <algorithm>

namespace shearwake::spectral {

SpectralMarch::SpectralMarch(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                             const TimeStep& time, const Comm& team)
    : case_(c), layers_(without_rigid_bodies(c)), slabs_(slabs), per_frame_(time.per_frame),
      stepper_(c, mesh, slabs, time.step_s, team), inside_(c, slabs.share()),
      tensors_(layers_, mesh, slabs, time.step_s, team, &stepper_.bodies()),
      receptors_(layers_, stress_depths_m(c), mesh, slabs, time.step_s, team, &stepper_.bodies()) {
    for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
        levels_m_.push_back(mesh.z_m(level));
    together(team, [&] { plane_.resize(static_cast<std::size_t>(slabs.share().reals)); });
}

std::optional<std::size_t> SpectralMarch::snapshot(std::ptrdiff_t step) const {
    if (step % per_frame_ != 0) return {};
    return engines::snapshot_at(case_, step / per_frame_);
}

void SpectralMarch::advance() {
    const std::ptrdiff_t began = stepper_.step();
    if (tensors_.wanted()) remembered_snapshot_ = snapshot(began);
    if (receptors_.wanted() && began > 0 && began % per_frame_ == 0)
        remembered_frame_ = began / per_frame_ - 1;
    if (remembered_snapshot_) tensors_.remember(stepper_);
    if (remembered_frame_) receptors_.remember(stepper_.before().data());
    stepper_.advance();
}

void SpectralMarch::give(engines::Observer& observer) {
    give_earlier(observer);
    const std::ptrdiff_t step = stepper_.step();
    if (step % per_frame_ == 0) give_frame(step / per_frame_ - 1, observer);
    const auto& kept = case_.record.volume_fields;
    const auto u = std::find(kept.begin(), kept.end(), VolumeField::u);
    if (const auto now = snapshot(step); now && u != kept.end())
        give_displacement(*now, static_cast<std::size_t>(u - kept.begin()), observer);
}

/// Passes the output that refers to the start of the last step.
void SpectralMarch::give_earlier(engines::Observer& observer) {
    if (remembered_snapshot_) tensors_.give(stepper_, inside_, *remembered_snapshot_, observer);
    if (remembered_frame_)
        receptors_.give({stepper_.before().data(), stepper_.now().data()},
                        stepper_.bodies().step_forces(), *remembered_frame_, observer);
    remembered_snapshot_.reset();
    remembered_frame_.reset();
}

void SpectralMarch::give_frame(std::ptrdiff_t number, engines::Observer& observer) {
    for (std::size_t depth = 0; depth < case_.measure.depths_m.size(); ++depth) {
        stepper_.plane_of_w(case_.measure.depths_m[depth], plane_.data());
        slabs_.to_physical(plane_.data());
        observer.frame({.number = number, .depth = depth, .u_z_m = plane()});
    }
}

void SpectralMarch::give_displacement(std::size_t snapshot, std::size_t field,
                                      engines::Observer& observer) {
    for (std::size_t component = 0; component < 3; ++component)
        for (std::size_t level = 0; level < levels_m_.size(); ++level) {
            stepper_.plane_of_u(component, level, plane_.data());
            slabs_.to_physical(plane_.data());
            inside_.set_displacement(levels_m_[level], component, stepper_.bodies().motions(),
                                     plane_.data());
            observer.volume({.snapshot = snapshot,
                             .field = field,
                             .component = component,
                             .level = level,
                             .values = plane()});
        }
}

View2<const double> SpectralMarch::plane() const {
    const fft::SlabShare& share = slabs_.share();
    return {plane_.data(), share.x_count, case_.domain.ny, share.padded_ny};
}

void SpectralMarch::finish(engines::Observer& observer) {
    if (!receptors_.wanted() && !(tensors_.wanted() && snapshot(stepper_.step()))) return;
    advance();
    give_earlier(observer);
}

} // namespace shearwake::spectral
