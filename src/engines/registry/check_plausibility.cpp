// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"

#include "base/units.hpp"
#include "problem/load/motion/course.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <limits>

namespace shearwake {
namespace {

/// Strain above which the linear model is doubtful. The largest principal strain below a pressure p
/// on an incompressible half-space is about .155 p/mu (Hertz: the shear stress is .31 p).
constexpr double tolerated_strain = 0.05, strain_per_pressure = 0.155;
/// Devices in air reach a radiation pressure of some kPa; such a sound pressure is common.
constexpr double sound_pressure_Pa = 5e3;
/// rho c^2 of air [Pa]: a sound wave of the amplitude p presses with p^2/(rho c^2) on skin.
constexpr double air_modulus_Pa = 1.204 * 343.2 * 343.2;

void check_pressure(const Case& c, Notes& notes) {
    const Medium& medium = c.scene().medium;
    const double width_m = fwhm_m(c.scene().load.footprint), peak_Pa = c.scene().load.peak_Pa;
    double softest_Pa = std::numeric_limits<double>::infinity(), top_m = 0.0;
    for (std::size_t i = 0; i < medium.layers.size() && top_m < width_m; ++i) {
        const Layer& layer = medium.layers[i];
        softest_Pa = std::min(softest_Pa, layer.density_kg_m3 * layer.c_s_m_s * layer.c_s_m_s);
        top_m += layer.thickness_m;
    }
    const double strain = strain_per_pressure * peak_Pa / softest_Pa;
    if (!(strain > tolerated_strain || peak_Pa > sound_pressure_Pa)) return;
    notes.add(
        Severity::warning, "load.peak_Pa",
        "a radiation pressure of {:.3g} Pa strains the tissue by about {:.2g} %{}; devices in "
        "air reach 50 to some 1000 Pa; if {:.3g} Pa is the amplitude p of the sound pressure, "
        "use the radiation pressure p^2/(rho c^2) = {:.3g} Pa",
        peak_Pa, 100.0 * strain,
        strain > tolerated_strain ? ", but the model is linear and valid for a few per cent" : "",
        peak_Pa, peak_Pa * peak_Pa / air_modulus_Pa);
}

/// Lengths that were probably given in m instead of mm are this much smaller than the focus.
constexpr double tiny_share = 0.05;

/// The largest distance of a point of a path from its start.
double reach_of_path_m(const Curve& path) {
    constexpr int points = 64;
    double reach_m = 0.0;
    for (int i = 1; i <= points; ++i)
        reach_m = std::max(reach_m,
                           norm(point_m(path, length_m(path) * i / points) - point_m(path, 0.0)));
    return reach_m;
}

/// Lengths far below the focus, and times below an output interval: typed in m or s.
void check_units(const Case& c, Notes& notes) {
    const Scene& scene = c.scene();
    const double width_m = fwhm_m(scene.load.footprint), interval_s = c.time.interval_s;
    double thickness_m = 0.0;
    for (const Layer& layer : scene.medium.layers)
        thickness_m += layer.thickness_m;
    if (scene.medium.base == Base::rigid && thickness_m < tiny_share * width_m)
        notes.add(
            Severity::warning, "medium.layer",
            "the layers are {:.3g} mm thick in total, but the focus is {:.3g} mm wide (FWHM): "
            "the base below them determines the motion; thickness_mm is in mm",
            milli(thickness_m), milli(width_m));
    for (std::size_t i = 0; i < scene.medium.layers.size(); ++i)
        if (const Layer& layer = scene.medium.layers[i]; layer.density_kg_m3 < 50.0)
            notes.add(Severity::warning, "medium.layer",
                      "layer {} has a density of {:.3g} kg/m^3, but that of tissue is about 1000 "
                      "kg/m^3",
                      i + 1, layer.density_kg_m3);
    const auto check_length = [&](const char* key, double length_m, const char* what) {
        if (length_m > 0.0 && length_m < tiny_share * width_m)
            notes.add(
                Severity::warning, key,
                "{} is {:.3g} mm, but the focus is {:.3g} mm wide (FWHM): it is practically at "
                "rest; lengths are in mm",
                what, milli(length_m), milli(width_m));
    };
    const auto check_time = [&](const char* key, double time_s) {
        if (time_s > 0.0 && time_s < interval_s * (1.0 - 1e-9))
            notes.add(Severity::warning, key,
                      "{:.3g} ms is shorter than the output interval of {:.3g} us and has no "
                      "effect on what is recorded; the time is in ms",
                      milli(time_s), 1e6 * interval_s);
    };
    for (const Mover& mover : scene.load.modulation.trajectory.parts) {
        if (const auto* travel = std::get_if<Travel>(&mover)) {
            check_length("load.modulation.path", reach_of_path_m(travel->path),
                         "the size of the path");
            check_time("load.modulation.corner_dwell_ms", travel->corners.dwell_s);
        } else if (const auto* swing = std::get_if<Swing>(&mover)) {
            check_length("load.modulation.lm_amplitude_mm", norm(swing->amplitude_m),
                         "the amplitude of the motion");
        }
    }
    for (const Gain& gain : scene.load.modulation.envelope.gains)
        if (const auto* ramp = std::get_if<RampGain>(&gain))
            check_time("load.modulation.ramp_ms", ramp->duration_s);
    check_time("measure.settled_after_ms", c.measure.settled_after_s);
}

/// Tactile pointers (DTP, STP) are felt as points that move. From this many drawings per second on,
/// the range of flutter, the shape is felt as a whole.
constexpr double fastest_pointer_Hz = 10.0;

void check_pointer(const Case& c, Notes& notes) {
    const Modulation& modulation = c.scene().load.modulation;
    if ((modulation.kind != "DTP" && modulation.kind != "STP") ||
        modulation.trajectory.parts.empty())
        return;
    const auto* travel = std::get_if<Travel>(&modulation.trajectory.parts.front());
    if (!travel || !(1.0 / cycle_s(*travel) > fastest_pointer_Hz)) return;
    const bool is_dtp = modulation.kind == "DTP";
    notes.add(
        Severity::warning, "load.modulation.kind",
        "the pointer of {} draws {:.3g} shapes per second, but a pointer moves slowly, with at "
        "most {:.0f} shapes per second: {}",
        modulation.kind, 1.0 / cycle_s(*travel), fastest_pointer_Hz,
        is_dtp ? travel->corners == CornerPace{}
                     ? "this load is identical to that of AM-STM"
                     : "this load is AM-STM with rests or slow parts at corners"
               : "this load is STM along a path with loops");
}

} // namespace

std::vector<Remark> check_plausibility(const Case& c) {
    Notes notes;
    check_pressure(c, notes);
    check_units(c, notes);
    check_pointer(c, notes);
    return notes.remarks;
}

} // namespace shearwake
