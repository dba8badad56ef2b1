// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/estimate.hpp"

#include "engines/pstd/pstd_engine.hpp"
#include "engines/pstd/scheme/stepper.hpp"

namespace shearwake::pstd {
namespace {

/// Values that a step reads and writes per point: totals, stored parts, and the transforms of
/// gradients.
double values_per_point(Absorption absorption) {
    return absorption != Absorption::none ? 9.0 + 15.0 + 15.0 : 9.0 + 15.0 + 6.0;
}

Case calibration_case(std::ptrdiff_t nx, std::ptrdiff_t ny, double depth_m, Precision precision,
                      double viscosity_Pa_s) {
    Case c = engines::calibration_case({{0.0, 5.0, viscosity_Pa_s}}, 4e-3, {nx, ny, 1e-3, 0.0},
                                       {1, 30e-6});
    c.solver = PstdOptions{
        .time_step_s = 5e-6, .depth_m = depth_m, .absorbing_points = 8, .precision = precision};
    return c;
}

} // namespace

engines::Estimate estimate_steps(const StepWork& work) {
    const bool lossy = work.absorption != Absorption::none;
    const double of_value_B = work.precision == Precision::single_precision ? 4.0 : 8.0;
    const double values = values_per_point(work.absorption);
    engines::Estimate e;
    e.work = {{step_kind(work.absorption, work.precision), work.points * work.steps},
              {work.uneven ? of_inclusions : of_begin, work.points}};
    // There and back, three stresses and then three velocities, where lossy with accelerations.
    const double fields = lossy ? 9.0 : 6.0;
    const std::ptrdiff_t parts =
        parts_of_exchange(work.points * of_value_B / work.ranks, work.ranks);
    e.all_to_alls = 2.0 * fields * static_cast<double>(parts) * work.steps;
    e.all_to_all_B = work.points * of_value_B / static_cast<double>(parts);
    const double coefficients = !work.uneven ? 0.0 : lossy ? 13.0 : 8.0;
    e.memory_per_rank_B =
        engines::program_B + of_value_B * (values + coefficients) * work.points / work.ranks;
    return e;
}

engines::Work work_of_frames(const Case& c) {
    return {of_frame, static_cast<double>(c.domain.nx * c.domain.ny * c.time.frames) *
                          static_cast<double>(c.measure.depths_m.size())};
}

engines::Work work_of_columns(const Case& c, double steps) {
    return {of_column, static_cast<double>(c.domain.nx * c.domain.ny) * steps};
}

engines::Work work_of_volumes(double points, double steps) {
    return {of_volume, points * steps};
}

std::vector<engines::Calibration> PstdEngine::calibrations() const {
    std::vector<engines::Calibration> all;
    for (const Precision precision : {Precision::double_precision, Precision::single_precision})
        for (const double viscosity_Pa_s : {0.0, 0.1}) {
            const engines::WorkKind& kind = step_kind(
                viscosity_Pa_s > 0.0 ? Absorption::kelvin_voigt : Absorption::none, precision);
            all.push_back({kind.name, calibration_case(96, 72, 24e-3, precision, viscosity_Pa_s)});
        }
    Case begin = calibration_case(64, 48, 10e-3, Precision::double_precision, 0.0);
    begin.time.interval_s = 5e-6;
    Case inclusions = begin;
    inclusions.scene().medium.bodies.push_back({.name = "body",
                                                .shape = Ellipsoid{{1e-2, 1e-2, 3e-3}},
                                                .centre_m = {0.0, 0.0, 5e-3},
                                                .c_s_m_s = 6.0});
    Case frame = calibration_case(64, 48, 10e-3, Precision::double_precision, 0.0);
    frame.time = {4, 5e-6};
    for (int depth = 0; depth < 40; ++depth)
        frame.measure.depths_m.push_back(2e-4 * (depth + 1));
    Case column = calibration_case(64, 48, 4e-3, Precision::double_precision, 0.0);
    Case volume = calibration_case(64, 48, 10e-3, Precision::double_precision, 0.0);
    volume.record.volumes_s = {volume.time.duration_s()};
    volume.record.volume_fields = {VolumeField::u};
    for (Case* c : {&begin, &inclusions, &frame, &volume, &column})
        c->measure.at_s = c->time.duration_s();
    all.insert(all.end(), {{of_begin.name, begin},
                           {of_inclusions.name, inclusions},
                           {of_frame.name, frame},
                           {of_column.name, column},
                           {of_volume.name, volume}});
    return all;
}

} // namespace shearwake::pstd
