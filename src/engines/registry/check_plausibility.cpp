// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"

#include "base/units.hpp"
#include "problem/load/acoustics/hologram.hpp"
#include "problem/load/motion/trajectory.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake {
namespace {

/// Strain above which the linear model is doubtful. The largest principal strain below a pressure p
/// on an incompressible half-space is about .155 p/mu (Hertz: the shear stress is .31 p).
constexpr double tolerated_strain = 0.05, strain_per_pressure = 0.155;
/// Devices in air reach a radiation pressure of at most some kPa; such a sound pressure is common.
constexpr double sound_pressure_Pa = 3e3;
/// Radiation pressures below this that hardly strain the tissue are probably in kPa. Studies may
/// use 1 Pa as a unit.
constexpr double least_pressure_Pa = 1.0, perceptible_strain = 1e-5;
/// Shear moduli from this on are those of tendons, cartilage and bone; skin has 1 kPa to 1 MPa.
constexpr double stiff_Pa = 1e7;
/// rho c^2 of air [Pa]: a sound wave of the amplitude p presses with p^2/(rho c^2) on skin.
constexpr double air_modulus_Pa = 1.204 * 343.2 * 343.2;

void check_pressure(const Case& c, Notes& notes) {
    const Medium& medium = c.scene.medium;
    const double width_m = fwhm_m(c.scene.load.footprint), peak_Pa = c.scene.load.peak_Pa;
    double softest_Pa = std::numeric_limits<double>::infinity(), top_m = 0.0;
    for (std::size_t i = 0; i < medium.layers.size() && top_m < width_m; ++i) {
        const Layer& layer = medium.layers[i];
        softest_Pa = std::min(softest_Pa, layer.density_kg_m3 * layer.c_s_m_s * layer.c_s_m_s);
        top_m += layer.thickness_m;
    }
    if (softest_Pa > stiff_Pa)
        notes.add(Severity::warning, "medium.layer",
                  "below the focus, the shear modulus rho c_s^2 is at least {:.2g} Pa, that of "
                  "cartilage or bone; skin has 1 kPa to 1 MPa and c_s of 1 to 30 m/s",
                  softest_Pa);
    const double strain = strain_per_pressure * peak_Pa / softest_Pa;
    if (peak_Pa < least_pressure_Pa && strain < perceptible_strain)
        notes.add(Severity::warning, "load.peak_Pa",
                  "a radiation pressure of {:.3g} Pa is far below those of devices in air, 50 to "
                  "some 1000 Pa; peak_Pa is in Pa",
                  peak_Pa);
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
/// Paths of up to 300 mm are too with a focus of 3 mm. Swings may be small.
constexpr double tiny_path_share = 0.1;
/// A run that is a smaller part of a pass along the path: the speed was probably given in another
/// unit, such as a frequency in kHz.
constexpr double least_share_of_path = 0.02;
/// Shear waves of a Kelvin-Voigt layer are overdamped above mu/(2 pi viscosity). Tissue has some
/// 100 Hz. Below this, viscosities that are larger than those of tissue are probably in mPa s.
constexpr double least_damping_Hz = 10.0, large_viscosity_Pa_s = 50.0;
/// Layers from aerogels to stone.
constexpr double least_density_kg_m3 = 50.0, greatest_density_kg_m3 = 4000.0;
/// A person is not thicker than this. Below this ratio of speeds, Poisson's ratio is below .05.
constexpr double greatest_thickness_m = 1.0, least_speed_ratio = 1.45;

/// Bodies may be of tungsten.
constexpr double greatest_density_of_body_kg_m3 = 25000.0;
/// A scan with fewer samples, or with more noise (skin moves with some mm/s), shows nothing.
constexpr double least_samples = 4.0, greatest_noise_m_s = 0.1;
/// Loads that are weaker than this until the end of the run begin after it.
constexpr double least_strength = 0.1;

/// The largest distance of a point of a path from its start.
double reach_of_path_m(const Curve& path) {
    constexpr int points = 64;
    double reach_m = 0.0;
    for (int i = 1; i <= points; ++i)
        reach_m = std::max(reach_m,
                           norm(point_m(path, length_m(path) * i / points) - point_m(path, 0.0)));
    return reach_m;
}

/// Layers whose density, viscosity, thickness or c_p was probably given in g/cm^3, mPa s, um or
/// km/s.
void check_layers(const Case& c, Notes& notes) {
    const std::vector<Layer>& layers = c.scene.medium.layers;
    for (std::size_t i = 0; i < layers.size(); ++i) {
        const Layer& layer = layers[i];
        if (layer.density_kg_m3 < least_density_kg_m3 ||
            layer.density_kg_m3 > greatest_density_kg_m3)
            notes.add(Severity::warning, "medium.layer",
                      "layer {} has a density of {:.3g} kg/m^3, but that of tissue is about 1000 "
                      "kg/m^3",
                      i + 1, layer.density_kg_m3);
        if (std::isfinite(layer.thickness_m) && layer.thickness_m > greatest_thickness_m)
            notes.add(Severity::warning, "medium.layer",
                      "layer {} is {:.4g} mm thick; thickness_mm is in mm, and medium.base = "
                      "\"half-space\" continues the last layer without end",
                      i + 1, milli(layer.thickness_m));
        if (layer.c_p_m_s < least_speed_ratio * layer.c_s_m_s)
            notes.add(Severity::warning, "medium.layer",
                      "layer {} has c_p = {:.4g} m/s and c_s = {:.4g} m/s; tissue is nearly "
                      "incompressible, with c_p of about 1500 m/s",
                      i + 1, layer.c_p_m_s, layer.c_s_m_s);
        const double viscosity_Pa_s = newtonian_viscosity_Pa_s(layer.loss).value_or(0.0);
        if (!(viscosity_Pa_s > large_viscosity_Pa_s)) continue;
        const double damping_Hz = static_shear_modulus(layer) / (two_pi * viscosity_Pa_s);
        if (damping_Hz < least_damping_Hz)
            notes.add(Severity::warning, "medium.layer",
                      "the viscosity of layer {}, {:.3g} Pa s, exceeds the shear modulus above "
                      "{:.2g} Hz, so that hardly any wave travels; tissue has 0.1 to 20 Pa s",
                      i + 1, viscosity_Pa_s, damping_Hz);
    }
}

/// Coordinates that are not zero, but far below the spacing: typed in m.
void check_coordinates(const Case& c, Notes& notes) {
    const auto check_points = [&](const char* key, const std::vector<Vec2>& points_m) {
        const double tiny_m = tiny_share * c.domain.spacing_m, rounding_m = 1e-9;
        for (const Vec2 point_m : points_m)
            if (norm(point_m) > rounding_m && norm(point_m) < tiny_m)
                return notes.add(Severity::warning, key,
                                 "[{:.3g}, {:.3g}] mm is closer to the centre than {:.0f} % of the "
                                 "spacing of {:.3g} mm; coordinates are in mm",
                                 milli(point_m.x), milli(point_m.y), 100.0 * tiny_share,
                                 milli(c.domain.spacing_m));
    };
    check_points("record.traces_mm", c.record.traces_m);
    if (c.afferents) check_points("afferents.pins_mm", c.afferents->pins_m);
    for (const Mover& mover : c.scene.load.modulation.trajectory.parts)
        if (const auto* hold = std::get_if<Hold>(&mover))
            check_points("load.modulation.position_mm", {hold->at_m});
    check_points("load.modulation.foci_mm", c.scene.load.modulation.foci_m);
    for (const Body& body : c.scene.medium.bodies)
        check_points("medium.body", {{body.centre_m.x, body.centre_m.y}});
    for (const double depth_m : c.measure.depths_m)
        if (depth_m > 0.0 && depth_m < tiny_share * tiny_share * c.domain.spacing_m)
            notes.add(Severity::warning, "measure.depths_mm",
                      "{:.3g} mm is at the surface, compared with the spacing of {:.3g} mm; depths "
                      "are in mm",
                      milli(depth_m), milli(c.domain.spacing_m));
}

/// The layer at a depth; the last one below all.
const Layer& layer_at(const Medium& medium, double depth_m) {
    std::size_t i = 0;
    while (i + 1 < medium.layers.size() && depths(medium, i).bottom_m <= depth_m)
        ++i;
    return medium.layers[i];
}

/// Bodies whose density, viscosity or depth was probably given in g/cm^3, mPa s or m.
void check_bodies(const Case& c, Notes& notes) {
    const Medium& medium = c.scene.medium;
    for (std::size_t i = 0; i < medium.bodies.size(); ++i) {
        const Body& body = medium.bodies[i];
        const Layer& around = layer_at(medium, body.centre_m.z);
        const double density_kg_m3 = body.density_kg_m3.value_or(around.density_kg_m3);
        if (body.density_kg_m3 &&
            (density_kg_m3 < least_density_kg_m3 || density_kg_m3 > greatest_density_of_body_kg_m3))
            notes.add(Severity::warning, "medium.body",
                      "body {} has a density of {:.3g} kg/m^3, but that of tissue is about 1000 "
                      "kg/m^3",
                      i + 1, density_kg_m3);
        const double c_s_m_s = body.c_s_m_s.value_or(around.c_s_m_s),
                     viscosity_Pa_s = body.viscosity_Pa_s.value_or(0.0),
                     damping_Hz = density_kg_m3 * c_s_m_s * c_s_m_s / (two_pi * viscosity_Pa_s);
        if (c_s_m_s > 0.0 && viscosity_Pa_s > large_viscosity_Pa_s && damping_Hz < least_damping_Hz)
            notes.add(Severity::warning, "medium.body",
                      "the viscosity of body {}, {:.3g} Pa s, exceeds its shear modulus above "
                      "{:.2g} Hz; tissue has 0.1 to 20 Pa s",
                      i + 1, viscosity_Pa_s, damping_Hz);
        const Bounds box = bounds(body);
        const double height_m = box.high_m.z - box.low_m.z;
        // A body may be half of an ellipsoid, whose centre is at a depth of exactly 0.
        if (std::isfinite(height_m) && body.centre_m.z > 0.0 &&
            body.centre_m.z < tiny_share * height_m)
            notes.add(Severity::warning, "medium.body",
                      "{:.0f} % of the height of body {} lie above the skin and have no effect; "
                      "its centre is at a depth of {:.3g} mm, lengths are in mm",
                      -100.0 * box.low_m.z / height_m, i + 1, milli(body.centre_m.z));
    }
}

/// Measured regions without the focus, or narrower than the focal disc.
void check_region(const Case& c, Notes& notes) {
    const std::vector<Vec2>& region_m = c.measure.region_m;
    if (region_m.empty()) return;
    const auto by_x = std::ranges::minmax(region_m, {}, &Vec2::x),
               by_y = std::ranges::minmax(region_m, {}, &Vec2::y);
    const Vec2 low_m{by_x.min.x, by_y.min.y}, high_m{by_x.max.x, by_y.max.y};
    const double width_m = std::min(high_m.x - low_m.x, high_m.y - low_m.y),
                 disc_m = 2.0 * c.measure.focal_radius_m;
    if (width_m < disc_m)
        notes.add(Severity::warning, "measure.region_mm",
                  "the region is {:.3g} mm wide, but the focal disc {:.3g} mm: the efficiency is "
                  "the share of the disc in the region, whatever energy leaves the region",
                  milli(width_m), milli(disc_m));
    const Modulation& modulation = c.scene.load.modulation;
    if (c.measure.at_s >= off_time_s(modulation.trajectory)) return;
    const Vec2 at_m = position(modulation.trajectory, c.measure.at_s);
    const auto is_measured = [&](Vec2 focus_m) {
        const Vec2 p = at_m + focus_m;
        const double beyond_m =
            std::max({low_m.x - p.x, p.x - high_m.x, low_m.y - p.y, p.y - high_m.y, 0.0});
        return is_inside(region_m, p) || beyond_m < c.measure.focal_radius_m;
    };
    if (modulation.foci_m.empty() ? !is_measured({})
                                  : std::ranges::none_of(modulation.foci_m, is_measured))
        notes.add(Severity::warning, "measure.region_mm",
                  "at {:.4g} ms the focus is at [{:.3g}, {:.3g}] mm, outside of the region: the "
                  "efficiency there is 0",
                  milli(c.measure.at_s), milli(at_m.x), milli(at_m.y));
}

/// Samples after the run, too few of them, too much noise, and scans of a point: other units.
void check_vibrometer(const Case& c, Notes& notes) {
    if (!c.vibrometer) return;
    const VibrometerOptions& scan = *c.vibrometer;
    const bool is_transient = c.time.regime == Regime::transient;
    const double end_s = c.time.duration_s(),
                 scan_s = is_transient ? end_s - scan.trigger_delay_s : end_s;
    const double rate_Hz = scan.rate_Hz > 0.0 ? scan.rate_Hz : 1.0 / c.time.interval_s;
    if (scan_s <= 0.0)
        notes.add(Severity::warning, "vibrometer.trigger_delay_ms",
                  "the first sample is at {:.4g} ms, but the run ends at {:.4g} ms: the scan has "
                  "no samples; trigger_delay_ms is in ms",
                  milli(scan.trigger_delay_s), milli(end_s));
    else if (rate_Hz * scan_s < least_samples)
        notes.add(Severity::warning, "vibrometer.sampling_rate_kHz",
                  "{:.3g} samples per second are {:.2g} samples in {:.4g} ms; sampling_rate_kHz is "
                  "in kHz",
                  rate_Hz, rate_Hz * scan_s, milli(scan_s));
    const double noise_m_s = scan.noise_m_s_rtHz * std::sqrt(0.5 * rate_Hz / scan.averages);
    if (noise_m_s > greatest_noise_m_s)
        notes.add(Severity::warning, "vibrometer.noise_um_s_rtHz",
                  "the noise has an rms of {:.2g} m/s, more than any motion of skin; vibrometers "
                  "have 0.01 to 10 um/s per square root of Hz",
                  noise_m_s);
    double reach_m = 0.0;
    for (const Vec2 point_m : scan.points_m)
        reach_m = std::max(reach_m, norm(point_m - scan.points_m.front()));
    if (reach_m > 0.0 && reach_m < tiny_share * c.domain.spacing_m)
        notes.add(Severity::warning, "vibrometer",
                  "the points of the scan lie within {:.3g} mm, but the spacing is {:.3g} mm; "
                  "lengths are in mm",
                  milli(reach_m), milli(c.domain.spacing_m));
}

/// A length far below the focus: typed in m.
void check_length(const Case& c, const char* key, double length_m, double share, const char* what,
                  Notes& notes) {
    const double width_m = fwhm_m(c.scene.load.footprint);
    if (length_m > 2e-9 && length_m < share * width_m) // less: a list of points at one place
        notes.add(Severity::warning, key,
                  "{} is {:.3g} mm, but the focus is {:.3g} mm wide (FWHM): it is practically at "
                  "rest; lengths are in mm",
                  what, milli(length_m), milli(width_m));
}

/// A time below an output interval: typed in s.
void check_time(const Case& c, const char* key, double time_s, Notes& notes) {
    if (time_s > 0.0 && time_s < c.time.interval_s * (1.0 - 1e-9))
        notes.add(Severity::warning, key,
                  "{:.3g} ms is shorter than the output interval of {:.3g} us and has no effect on "
                  "what is recorded; the time is in ms",
                  milli(time_s), 1e6 * c.time.interval_s);
}

void check_modulation_units(const Case& c, Notes& notes) {
    const Modulation& modulation = c.scene.load.modulation;
    const bool is_transient = c.time.regime == Regime::transient;
    const double end_s = c.time.duration_s();
    for (const Mover& mover : modulation.trajectory.parts) {
        const auto check_travel = [&](const Travel& travel) {
            check_length(c, "load.modulation.path", reach_of_path_m(travel.path), tiny_path_share,
                         "the size of the path", notes);
            const double pass_s = cycle_s(travel);
            if (is_transient && std::isfinite(pass_s) && end_s < least_share_of_path * pass_s)
                notes.add(Severity::warning, "load.modulation",
                          "a pass along the path lasts {:.4g} ms, but the run {:.4g} ms, which is "
                          "{:.2g} % of it; speeds are in m/s, frequencies in Hz, times in ms",
                          milli(pass_s), milli(end_s), 100.0 * end_s / pass_s);
            check_time(c, "load.modulation.corner_dwell_ms", travel.corners.dwell_s, notes);
        };
        const auto check_swing = [&](const Swing& swing) {
            check_length(c, "load.modulation.lm_amplitude_mm", norm(swing.amplitude_m), tiny_share,
                         "the amplitude of the motion", notes);
        };
        std::visit(overloaded{[](const Hold&) {}, check_swing, check_travel}, mover);
    }
    for (const Gain& part : modulation.envelope.gains) {
        if (const auto* ramp = std::get_if<RampGain>(&part))
            check_time(c, "load.modulation.ramp_ms", ramp->duration_s, notes);
        if (const double most = largest(part, end_s); is_transient && most < least_strength)
            notes.add(Severity::warning, "load.modulation",
                      "until the run ends at {:.4g} ms, a ramp or window lets the load reach only "
                      "{:.2g} % of its strength; times are in ms",
                      milli(end_s), 100.0 * most);
    }
}

/// Lengths far below the focus, and times below an output interval: typed in m or s.
void check_units(const Case& c, Notes& notes) {
    const Scene& scene = c.scene;
    const double width_m = fwhm_m(scene.load.footprint), interval_s = c.time.interval_s;
    double thickness_m = 0.0, fastest_m_s = 0.0;
    for (const Layer& layer : scene.medium.layers) {
        thickness_m += layer.thickness_m;
        fastest_m_s = std::max(fastest_m_s, layer.c_s_m_s);
    }
    const double end_s = c.time.duration_s(), wave_m = fastest_m_s * end_s;
    const bool is_transient = c.time.regime == Regime::transient;
    if (is_transient && wave_m < tiny_share * width_m)
        notes.add(Severity::warning, "time.duration_ms",
                  "within {:.3g} ms, shear waves travel {:.3g} mm, but the focus is {:.3g} mm wide "
                  "(FWHM): the tissue hardly moves; duration_ms is in ms",
                  milli(end_s), milli(wave_m), milli(width_m));
    if (scene.medium.base == Base::rigid && thickness_m < tiny_share * width_m)
        notes.add(
            Severity::warning, "medium.layer",
            "the layers are {:.3g} mm thick in total, but the focus is {:.3g} mm wide (FWHM): "
            "the base below them determines the motion; thickness_mm is in mm",
            milli(thickness_m), milli(width_m));
    check_modulation_units(c, notes);
    const double settled_s = c.measure.settled_after_s;
    check_time(c, "measure.settled_after_ms", settled_s, notes);
    if (is_transient && settled_s >= interval_s && fastest_m_s * settled_s < tiny_share * width_m)
        notes.add(Severity::warning, "measure.settled_after_ms",
                  "within {:.3g} ms, shear waves travel {:.3g} mm, but the focus is {:.3g} mm wide "
                  "(FWHM): nothing settles in this time; settled_after_ms is in ms",
                  milli(settled_s), milli(fastest_m_s * settled_s), milli(width_m));
}

/// Tactile pointers (DTP, STP) are felt as points that move. From this many drawings per second on,
/// the range of flutter, the shape is felt as a whole.
constexpr double fastest_pointer_Hz = 10.0;

void check_pointer(const Case& c, Notes& notes) {
    const Modulation& modulation = c.scene.load.modulation;
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
    check_layers(c, notes);
    check_coordinates(c, notes);
    check_units(c, notes);
    check_bodies(c, notes);
    check_region(c, notes);
    check_vibrometer(c, notes);
    check_pointer(c, notes);
    return notes.remarks;
}

} // namespace shearwake
