// SPDX-License-Identifier: BSD-3-Clause
#include "engines/registry/check.hpp"

#include "base/units.hpp"
#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "measures/sensation.hpp"
#include "problem/case/edges.hpp"
#include "problem/load/motion/trajectory.hpp"
#include "problem/medium/material_field.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shearwake {

namespace {

/// Minimum number of points per width: with fewer, the grid does not represent the footprint.
constexpr double least_points_per_fwhm = 1.5;
constexpr double good_points_per_fwhm = 3.0;
/// The allowed value of the spectrum, relative to its peak, at the largest wave number of the grid.
constexpr double aliased_share = 1e-3;
/// The spectrum of the moving load is considered to end at this fraction of its peak.
constexpr double spectrum_end = 1e-2;
/// A layer thinner than this does not guide shear waves across the domain.
constexpr double thin_layer_m = 1e-3;
/// Maximum number of samples along the path: a fraction of a per mille of its length is sufficient.
constexpr double most_samples = 4000.0;
/// Largest number of periods of the highest frequency of a load.
constexpr double most_periods = 1e6;
/// Frames per period of the highest frequency of a load, and in a run, from which on an output
/// interval was probably given in ms.
constexpr double most_frames_per_period = 1000.0;
constexpr std::ptrdiff_t many_frames = 20000;
/// The share of a wave's energy that a sponge may give back, and the sponge's width that does it,
/// in wavelengths (case/edges.hpp).
constexpr double tolerated_return = 0.01;
double width_for(double wavelength_m) {
    return wavelength_m / 1.65;
}

/// The duration for which the load acts within the run.
double loaded_s(const Case& c) {
    return std::min(c.time.duration_s(), off_time_s(c.scene.load.modulation.trajectory));
}

/// Calls f(t, focus) for every focus along the path while the load is on, both ends included.
template <class F>
void at_times(const Case& c, F f) {
    const double end_s = loaded_s(c);
    const double step_s = std::max(c.time.interval_s, end_s / most_samples);
    for (double n = 0.0; n * step_s < end_s; ++n)
        f(n * step_s, foci(c.scene.load.modulation, n * step_s));
    f(end_s, foci(c.scene.load.modulation, end_s));
}

/// The same for each focus.
template <class F>
void along_path(const Case& c, F f) {
    at_times(c, [&](double t_s, const auto& at_m) {
        for (const Vec2& focus : at_m)
            f(t_s, focus);
    });
}

void check_focus_resolution(const Case& c, Notes& notes) {
    const double width_m = fwhm_m(c.scene.load.footprint), spacing_m = c.domain.spacing_m;
    const double points = width_m / spacing_m;
    const double share = spectrum(c.scene.load.footprint, std::numbers::pi / spacing_m, 0.0) /
                         spectrum(c.scene.load.footprint, 0.0, 0.0);
    const double wanted_mm = milli(width_m) / good_points_per_fwhm;
    if (points < least_points_per_fwhm)
        notes.add(Severity::error, "domain.spacing_mm",
                  "the focus is {:.3g} mm wide (FWHM) and the spacing is {:.3g} mm, which gives "
                  "{:.2g} points per width: the grid does not resolve the focus; use a spacing of "
                  "at most {:.3g} mm",
                  milli(width_m), milli(spacing_m), points, wanted_mm);
    else if (points < good_points_per_fwhm * (1.0 - 1e-9) || share > aliased_share)
        notes.add(Severity::warning, "domain.spacing_mm",
                  "the focus is {:.3g} mm wide (FWHM) and the spacing is {:.3g} mm, which gives "
                  "{:.2g} points per width: the spectrum of the focus still has {:.2g} of its peak "
                  "at the shortest shear wave that the grid represents; use {:.3g} mm",
                  milli(width_m), milli(spacing_m), points, share, wanted_mm);
}

/// Engines sample the load several times per period of its highest frequency. Returns false if
/// there are too many of them.
bool check_periods(const Case& c, Notes& notes) {
    const Load& load = c.scene.load;
    const double highest_Hz = bandwidth_rad_m(load.footprint, spectrum_end) *
                                  greatest_speed_m_s(load.modulation.trajectory) / two_pi +
                              greatest_envelope_frequency_Hz(load.modulation.envelope) +
                              carrier_frequency_Hz(load.carrier);
    const double periods = highest_Hz * c.time.duration_s();
    if (periods <= most_periods) return true;
    notes.add(
        Severity::error, "load.modulation",
        "contains frequencies up to {:.4g} Hz (speeds, gains and their edges and ramps, and a "
        "resolved carrier), of which {:.3g} periods fit into the run of {:.4g} ms; at most "
        "{:.0e} are supported: make it slower, its edges longer, or the run shorter",
        highest_Hz, periods, milli(c.time.duration_s()), most_periods);
    return false;
}

/// Frames must not be further apart than half of the shortest period of the load.
void check_sampling(const Case& c, Notes& notes) {
    const Modulation& modulation = c.scene.load.modulation;
    const double interval_s = c.time.interval_s;
    const double passing_Hz = bandwidth_rad_m(c.scene.load.footprint, spectrum_end) *
                              greatest_speed_m_s(modulation.trajectory) / two_pi;
    const double fastest_Hz = passing_Hz + greatest_envelope_frequency_Hz(modulation.envelope);
    if (fastest_Hz * interval_s > 0.5)
        notes.add(Severity::warning, "time.output_interval_us",
                  "the load contains frequencies up to {:.4g} Hz, but frames every {:.4g} us "
                  "represent it only up to {:.4g} Hz, so frames alias; use {:.3g} us",
                  fastest_Hz, 1e6 * interval_s, 0.5 / interval_s, 1e6 * 0.5 / fastest_Hz);
    else if (fastest_Hz > 0.0 && fastest_Hz * interval_s * most_frames_per_period < 1.0 &&
             c.time.frames > many_frames)
        notes.add(Severity::warning, "time.output_interval_us",
                  "the load contains frequencies up to {:.4g} Hz, but the {} frames every {:.4g} "
                  "us are {:.3g} per period of it, and 10 suffice; the interval is in us",
                  fastest_Hz, c.time.frames, 1e6 * interval_s, 1.0 / (fastest_Hz * interval_s));
    const auto frequency_Hz = modulation_frequency_Hz(modulation);
    if (frequency_Hz && *frequency_Hz * interval_s > 0.25)
        notes.add(Severity::warning, "time.output_interval_us",
                  "the modulation of {:.4g} Hz has fewer than four frames per period of {:.4g} us; "
                  "use {:.3g} us",
                  *frequency_Hz, 1e6 / *frequency_Hz, 1e6 * 0.25 / *frequency_Hz);
}

void check_focus_in_domain(const Case& c, Notes& notes) {
    const double half_x_m = 0.5 * c.domain.extent_x_m(), half_y_m = 0.5 * c.domain.extent_y_m();
    double room_m = std::min(half_x_m, half_y_m), when_s = 0.0;
    Vec2 nearest;
    along_path(c, [&](double t_s, Vec2 focus) {
        const double room = std::min(half_x_m - std::abs(focus.x), half_y_m - std::abs(focus.y));
        if (room >= room_m) return;
        room_m = room;
        when_s = t_s;
        nearest = focus;
    });
    const double margin_m = c.domain.sponge_m + 2.0 * fwhm_m(c.scene.load.footprint);
    if (room_m < 0.0)
        notes.add(Severity::error, "domain.extent_mm",
                  "the focus leaves the domain: at {:.4g} ms it is at [{:.4g}, {:.4g}] mm, but the "
                  "domain ends at {:.4g} and {:.4g} mm",
                  milli(when_s), milli(nearest.x), milli(nearest.y), milli(half_x_m),
                  milli(half_y_m));
    else if (room_m < margin_m)
        notes.add(
            Severity::warning, "domain.extent_mm",
            "at {:.4g} ms the focus is at [{:.4g}, {:.4g}] mm, {:.4g} mm from the edge, which is "
            "less than the sponge plus two focus widths, {:.4g} mm: the wake is truncated",
            milli(when_s), milli(nearest.x), milli(nearest.y), milli(room_m), milli(margin_m));
    const auto reach = reach_m(c.scene.load.footprint);
    if (reach && c.domain.edges == DomainEdges::periodic && room_m >= margin_m && room_m < *reach)
        notes.add(
            Severity::warning, "load.footprint",
            "the focus comes within {:.4g} mm of the edge, but side lobes of the footprint are "
            "computed up to {:.4g} mm from the focus: they also act on the opposite side of "
            "the domain; use a larger domain or reach_mm = {:.0f}",
            milli(room_m), milli(*reach), std::floor(milli(room_m)));
}

/// Shear waves cross the domain about as fast as in the fastest layer that is not a thin film.
double wave_speed_m_s(const Medium& medium) {
    double speed_m_s = 0.0;
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const Layer& layer = medium.layers[i];
        const bool endless = medium.base == Base::half_space && i + 1 == medium.layers.size();
        if (endless || medium.layers.size() == 1 || layer.thickness_m > thin_layer_m)
            speed_m_s = std::max(speed_m_s, layer.c_s_m_s);
    }
    return speed_m_s;
}

/// The domain is periodic: a wave that leaves at one edge enters at the opposite one, unless a
/// sponge absorbs it. check_sponge reports the energy that passes a sponge.
void check_wrap_around(const Case& c, const engines::Capabilities& can, Notes& notes) {
    if (can.edges != engines::Edges::periodic) return;
    const double speed_m_s = wave_speed_m_s(c.scene.medium), end_s = c.time.duration_s();
    if (!(speed_m_s > 0.0)) return;
    const double half_x_m = 0.5 * c.domain.extent_x_m(), half_y_m = 0.5 * c.domain.extent_y_m();
    double back_s = end_s, needed_x_m = 0.0, needed_y_m = 0.0;
    along_path(c, [&](double t_s, Vec2 focus) {
        // The margin is not measured, so a wave must also cross it on the far side.
        const double edge_m = std::min(half_x_m - std::abs(focus.x), half_y_m - std::abs(focus.y));
        back_s = std::min(back_s, t_s + (edge_m + c.domain.sponge_m) / speed_m_s);
        const double reach_m = speed_m_s * (end_s - t_s) - c.domain.sponge_m;
        needed_x_m = std::max(needed_x_m, 2.0 * (std::abs(focus.x) + reach_m));
        needed_y_m = std::max(needed_y_m, 2.0 * (std::abs(focus.y) + reach_m));
    });
    const double out_s = back_s - c.domain.sponge_m / speed_m_s;
    const bool starts_outside = out_s < 0.0; // reported elsewhere
    if (starts_outside || back_s >= end_s * (1.0 - 1e-9)) return;
    notes.add(Severity::warning, "domain.extent_mm",
              "waves of {:.4g} m/s leave through one edge and return through the opposite one into "
              "the measured region at {:.3g} ms, before the run ends at {:.4g} ms; a domain of "
              "{:.0f} x {:.0f} mm would prevent this{}",
              speed_m_s, milli(back_s), milli(end_s),
              std::ceil(milli(std::max(needed_x_m, c.domain.extent_x_m())) - 1e-6),
              std::ceil(milli(std::max(needed_y_m, c.domain.extent_y_m())) - 1e-6),
              can.has_open_edges ? ", and so would domain.edges = \"open\"" : "");
}

void check_sponge(const Case& c, engines::Edges edges, Notes& notes) {
    const double width_m = c.domain.sponge_m;
    if (!(width_m > 0.0) || edges == engines::Edges::layer || edges == engines::Edges::open) return;
    if (edges == engines::Edges::periodic) {
        notes.add(Severity::warning, "domain.sponge_mm",
                  "the edges of the engine \"{}\" are periodic and absorb nothing: the margin of "
                  "{:.4g} mm is only excluded from the measures",
                  engine_name(c.solver), milli(width_m));
        return;
    }
    const double wave_m = longest_wave_m(c.scene.load, edge_speed_m_s(c.scene.medium, width_m));
    const double share = returned_energy(wave_m, width_m);
    if (share > tolerated_return)
        notes.add(Severity::warning, "domain.sponge_mm",
                  "a margin of {:.4g} mm returns {:.2g} % of the energy of the longest waves "
                  "(wavelength {:.3g} mm); {:.3g} mm would keep this below 1 %",
                  milli(width_m), 100.0 * share, milli(wave_m), milli(width_for(wave_m)));
}

void check_measured_times(const Case& c, Notes& notes) {
    if (c.time.regime == Regime::periodic) return; // the window is the period
    const double off_s = off_time_s(c.scene.load.modulation.trajectory);
    if (off_s + c.time.interval_s < c.measure.at_s)
        notes.add(Severity::warning, "measure.at_ms",
                  "the path ends at {:.4g} ms, so there is no load at {:.4g} ms", milli(off_s),
                  milli(c.measure.at_s));
    const auto frequency_Hz = modulation_frequency_Hz(c.scene.load.modulation);
    const double window_s = c.measure.at_s - c.measure.settled_after_s;
    if (frequency_Hz && *frequency_Hz * window_s < 1.0 - 1e-9)
        notes.add(Severity::warning, "measure.settled_after_ms",
                  "a period of the modulation lasts {:.4g} ms and does not fit between {:.4g} and "
                  "{:.4g} ms: the period columns will be empty; reduce measure.settled_after_ms, "
                  "or increase time.duration_ms and measure.at_ms",
                  1e3 / *frequency_Hz, milli(c.measure.settled_after_s), milli(c.measure.at_s));
}

void check_sensation(const Case& c, Notes& notes) {
    if (!computes_sensation(c)) return;
    if (const std::string reason = measures::sensation_lines(c).reason; !reason.empty())
        notes.add(Severity::warning,
                  c.measure.sensation == Sensation::on ? "measure.sensation" : "time.regime",
                  "the columns felt_* will be empty: {}", reason);
}

void check_focal_disc(const Case& c, Notes& notes) {
    const double radius_m = c.measure.focal_radius_m;
    const double shorter_m = std::min(c.domain.extent_x_m(), c.domain.extent_y_m());
    if (radius_m < c.domain.spacing_m)
        notes.add(Severity::warning, "measure.focal_radius_mm",
                  "the radius of the focal disc, {:.3g} mm, is below the spacing of {:.3g} mm: the "
                  "disc contains only one or two samples",
                  milli(radius_m), milli(c.domain.spacing_m));
    else if (radius_m > 0.25 * shorter_m)
        notes.add(Severity::warning, "measure.focal_radius_mm",
                  "the radius of the focal disc, {:.4g} mm, is more than a quarter of the shorter "
                  "side of the domain, {:.4g} mm: eta is not informative",
                  milli(radius_m), milli(shorter_m));
}

/// The afferents sense the motion of the skin only through the pins.
void check_pins(const Case& c, Notes& notes) {
    if (!c.afferents || !follows_skin(c.afferents->input)) return;
    double nearest_m = std::numeric_limits<double>::infinity();
    along_path(c, [&](double, Vec2 focus) {
        for (const Vec2 pin_m : c.afferents->pins_m)
            nearest_m = std::min(nearest_m, norm(focus - pin_m));
    });
    const double width_m = fwhm_m(c.scene.load.footprint);
    if (nearest_m > width_m)
        return notes.add(
            Severity::warning, "afferents.pins_mm",
            "no pin is near the focus: the smallest distance between them is {:.4g} mm, "
            "and the focus is {:.4g} mm wide (FWHM), so that the afferents sense only the "
            "waves around "
            "it; move the pins, or omit afferents.pins_mm to place them on the path",
            milli(nearest_m), milli(width_m));
    double farthest_m = 0.0; // of a pin from the nearest focus, at any time
    at_times(c, [&](double, const auto& at_m) {
        for (const Vec2 pin_m : c.afferents->pins_m) {
            double distance_m = std::numeric_limits<double>::infinity();
            for (const Vec2 focus_m : at_m)
                distance_m = std::min(distance_m, norm(focus_m - pin_m));
            farthest_m = std::max(farthest_m, distance_m);
        }
    });
    // A focus presses within half of its width. Pins farther away rise with its waves.
    if (c.afferents->pins_m.size() > 1 && farthest_m > 0.5 * width_m)
        notes.add(
            Severity::warning, "afferents.input",
            "some of {} pins are at times {:.3g} mm away from the focus, which is {:.3g} mm wide "
            "(FWHM), and may pull while others press; the model of pins is valid only if all have "
            "the same sign; use afferents.input = \"stress\" with engine \"layered\" or "
            "\"spectral\"",
            c.afferents->pins_m.size(), milli(farthest_m), milli(width_m));
}

void check_line_of_sight(const Case& c, Notes& notes) {
    if (wants_tangential(c) && !engines::capabilities_of(c).has_tangential)
        notes.add(Severity::error, "vibrometer.tilt_deg",
                  "a tilted line of sight needs the tangential displacement, which only the engine "
                  "\"layered\" with domain.edges = \"periodic\" computes; use them, or tilt_deg = "
                  "0");
}

} // namespace

bool has_image_uplift(const Case& c) {
    const engines::Capabilities can = engines::capabilities_of(c);
    return can.is_driven_by_force && can.edges == engines::Edges::periodic;
}

std::string image_uplift_text(const Case& c) {
    if (!has_image_uplift(c)) return "";
    constexpr double most_modes_times_frames = 1e7;
    const double modes = 75.0 * std::min(c.domain.extent_x_m(), c.domain.extent_y_m()) /
                         fwhm_m(c.scene.load.footprint);
    std::string size;
    if (modes * static_cast<double>(c.time.frames) < most_modes_times_frames) {
        double most_m = 0.0;
        for (const double uplift_m : image_uplift_m(c))
            most_m = std::max(most_m, std::abs(uplift_m));
        if (most_m == 0.0) return ""; // no P wave has crossed the domain
        size = fmt::format(" by up to {:.2g} um in case {}", 1e6 * most_m, case_id(c));
    }
    return fmt::format("the images of the load beyond the periodic edges lift the whole domain{}; "
                       "the run warns if this changes the field by more than 10 % or eta by more "
                       "than 2 %",
                       size);
}

std::vector<Remark> check(const Case& c) {
    const auto engine = engines::make_engine(c.solver);
    Notes notes;
    const auto add = [&](const std::vector<Remark>& remarks) {
        notes.remarks.insert(notes.remarks.end(), remarks.begin(), remarks.end());
    };
    check_line_of_sight(c, notes);
    if (!check_periods(c, notes)) return notes.remarks;
    check_focus_resolution(c, notes);
    check_sampling(c, notes);
    check_focus_in_domain(c, notes);
    check_wrap_around(c, engine->capabilities(c), notes);
    check_sponge(c, engine->capabilities(c).edges, notes);
    add(engine->limits(c));
    check_measured_times(c, notes);
    check_sensation(c, notes);
    check_focal_disc(c, notes);
    check_pins(c, notes);
    add(check_plausibility(c));
    add(check_variation(c));
    return notes.remarks;
}

} // namespace shearwake
