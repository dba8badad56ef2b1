// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/observers/kept_fields.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace shearwake::pipeline {

std::vector<std::ptrdiff_t> kept_frames(const Case& c) {
    std::vector<std::ptrdiff_t> kept;
    if (c.record.frames) {
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
            kept.push_back(n);
        return kept;
    }
    for (const double t_s : c.record.snapshots_s)
        kept.push_back(frame_at(c, t_s));
    std::sort(kept.begin(), kept.end());
    kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
    return kept;
}

KeptFields::KeptFields(const Case& c, storage::CaseFileWriter& writer)
    : case_(c), writer_(writer), frames_(kept_frames(c)) {}

void KeptFields::frame(const engines::Frame& frame) {
    const auto kept = std::lower_bound(frames_.begin(), frames_.end(), frame.number);
    if (kept != frames_.end() && *kept == frame.number)
        writer_.write_surface(static_cast<std::size_t>(kept - frames_.begin()), frame.depth,
                              frame.u_z_m, slab_.x_start);
}

void KeptFields::volume_levels(const std::vector<double>& z_m) {
    if (!case_.record.volumes_s.empty())
        writer_.begin_volume({.domain = case_.domain,
                              .times_s = case_.record.volumes_s,
                              .fields = case_.record.volume_fields,
                              .z_m = z_m},
                             slab_.x_count);
}

void KeptFields::volume(const engines::VolumePlane& plane) {
    writer_.write_volume(writer_.volume().variable(plane.field, plane.component), plane.snapshot,
                         plane.level, plane.values, slab_.x_start);
    volume_planes_ += 1.0;
}

void KeptFields::save(StateWriter& state) {
    writer_.flush();
    state.put("volume_planes", volume_planes_);
}

void KeptFields::restore(const StateReader& state) {
    volume_planes_ = state.get("volume_planes");
}

void KeptFields::finish() {
    if (case_.record.volumes_s.empty()) return;
    const storage::VolumeLayout& layout = writer_.volume();
    const auto wanted =
        static_cast<double>(layout.times_s.size() * layout.variables().size() * layout.z_m.size());
    if (wanted == 0.0 || volume_planes_ != wanted)
        throw CaseFailure(fmt::format("the engine provided {:.0f} of {:.0f} planes of the volumes",
                                      volume_planes_, wanted));
}

} // namespace shearwake::pipeline
