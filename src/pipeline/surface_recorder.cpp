// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/surface_recorder.hpp"

namespace shearwake::pipeline {
namespace {

std::vector<Vec2> pins_of(const Case& c) {
    const bool is_recorded = c.afferents && follows_skin(c.afferents->input);
    return is_recorded ? c.afferents->pins_m : std::vector<Vec2>{};
}

} // namespace

SurfaceRecorder::SurfaceRecorder(const Case& c, const Comm& team, const Sinks& sinks)
    : team_(team), tick_(sinks.tick), sums_(c, team), traces_(c, team, "trace", c.record.traces_m),
      pins_(c, team, "pin", pins_of(c)), stresses_(c, team), scan_(c, team), mean_(c, team),
      instant_(c, team), sensation_(c, team) {
    if (sinks.writer) parts_.push_back(&stored_.emplace(c, team, *sinks.writer));
    if (sinks.frames) parts_.push_back(&frames_.emplace(c, team, *sinks.frames));
    parts_.insert(parts_.end(),
                  {&sums_, &traces_, &pins_, &stresses_, &scan_, &mean_, &instant_, &sensation_});
}

void SurfaceRecorder::begin(const engines::Slab& slab) {
    for (Recording* part : parts_)
        part->begin(slab);
}

void SurfaceRecorder::frame(const engines::Frame& frame) {
    for (Recording* part : parts_)
        part->frame(frame);
    if (tick_) tick_();
}

void SurfaceRecorder::stress(const engines::StressFrame& frame) {
    for (Recording* part : parts_)
        part->stress(frame);
    if (tick_) tick_();
}

void SurfaceRecorder::tangential(const engines::TangentialFrame& frame) {
    for (Recording* part : parts_)
        part->tangential(frame);
    if (tick_) tick_();
}

void SurfaceRecorder::volume_levels(const std::vector<double>& z_m) {
    for (Recording* part : parts_)
        part->volume_levels(z_m);
}

void SurfaceRecorder::volume(const engines::VolumePlane& plane) {
    for (Recording* part : parts_)
        part->volume(plane);
}

void SurfaceRecorder::save(StateWriter& state) {
    RankParts(team_).save_ranks(state);
    for (Recording* part : parts_)
        part->save(state);
}

void SurfaceRecorder::restore(const StateReader& state) {
    for (Recording* part : parts_)
        part->restore(state);
}

void SurfaceRecorder::finish() {
    for (Recording* part : parts_)
        part->finish();
}

} // namespace shearwake::pipeline
