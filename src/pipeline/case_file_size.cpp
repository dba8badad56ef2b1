// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_file_size.hpp"

#include "measures/spectrum.hpp"
#include "measures/window.hpp"
#include "pipeline/afferent_estimate.hpp"
#include "pipeline/surface_recorder.hpp"

namespace shearwake::pipeline {
namespace {

/// Superblock, groups, about seventy variables with names, units and notes, attributes with the
/// job.
constexpr double empty_file_B = 28e3;
constexpr double of_group_B = 6e3; // size of a further group

bool has_mean(const Case& c) {
    return measures::period_window(c.measure, c.time,
                                   modulation_frequency_Hz(c.scene().load.modulation),
                                   off_time_s(c.scene().load.modulation.trajectory))
        .fits();
}

} // namespace

double case_file_B(const Case& c, double engine_B) {
    const double plane = static_cast<double>(c.domain.nx * c.domain.ny);
    const double depths = static_cast<double>(c.measure.depths_m.size());
    const double frames = static_cast<double>(c.time.frames);
    const double traces = static_cast<double>(c.record.traces_m.size());
    const double kept = static_cast<double>(kept_frames(c).size());
    double numbers = (4.0 + 12.0 * depths) * frames + depths * kept * plane;
    double groups = 0.0;
    if (traces > 0.0) {
        const double spectrum = static_cast<double>(measures::trace_frequencies_Hz(c.time).size());
        numbers += (traces + 1.0) * (frames + spectrum);
        groups += 1.0;
    }
    if (has_mean(c)) {
        numbers += plane;
        groups += 1.0;
    }
    if (c.afferents) groups += 3.0;
    if (!c.record.volumes_s.empty()) groups += 1.0;
    return empty_file_B + groups * of_group_B + numbers * sizeof(double) + afferents_file_B(c) +
           engine_B;
}

} // namespace shearwake::pipeline
