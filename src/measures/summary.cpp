// SPDX-License-Identifier: BSD-3-Clause
#include "measures/summary.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "measures/measure_table.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/spectrum.hpp"
#include "measures/window.hpp"
#include "problem/load/footprint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <span>

namespace shearwake::measures {
namespace {

constexpr double time_slack = 1e-9; // relative tolerance of times, for rounding

/// Sums at the instant and over the period window, if these exist.
struct Readings {
    std::optional<SurfaceSums> instant;
    std::string instant_note; // why there is none, or which frame is used instead
    std::optional<PeriodSums> period;
    std::vector<double> weights; // of the frames in `period`
    std::string period_note;
    double peak_m = not_a_number; // largest |u| of any frame up to the instant
};

/// The reason why the focal disc has no position at the instant: there a repeated path that is not
/// closed starts again. Empty if it has one.
std::string jump_reason(const Case& c) {
    const Modulation& modulation = c.scene.load.modulation;
    const double at_s = c.measure.at_s, aside_s = 1e-6 * c.time.interval_s;
    if (at_s <= aside_s) return {};
    const auto before = foci(modulation, at_s - aside_s), after = foci(modulation, at_s + aside_s);
    for (std::size_t i = 0; i < std::min(before.size(), after.size()); ++i)
        if (norm(after[i] - before[i]) > 0.1 * c.measure.focal_radius_m)
            return fmt::format("the focus jumps at the instant, {:g} ms, from the end of its path "
                               "to the start; measure.at_ms can select another instant",
                               at_s * 1e3);
    return {};
}

Readings read(const Case& c, const PeriodWindow& window, const DepthSeries& depth) {
    const TimeAxis& time = c.time;
    if (static_cast<std::ptrdiff_t>(depth.frames.size()) != time.frames)
        throw Error(fmt::format("{} frames of sums at depth {:g} mm, but the run has {}",
                                depth.frames.size(), depth.depth_m * 1e3, time.frames));
    Readings r{.period_note = window.reason};
    const double at = c.measure.at_s, in_frames = at / time.interval_s;
    const bool within = at <= time.duration_s() * (1.0 + time_slack);
    if (!within) {
        r.instant_note = fmt::format("the instant, {:g} ms, is after the end of the run at {:g} ms",
                                     at * 1e3, time.duration_s() * 1e3);
    } else if (in_frames < 0.5) {
        r.instant_note = "nothing has moved at the start of the run";
    } else if (const std::string none =
                   no_focus_reason(c.measure, time, off_time_s(c.scene.load.modulation.trajectory));
               !none.empty()) {
        r.instant_note = none;
    } else if (const std::string jump = jump_reason(c); !jump.empty()) {
        r.instant_note = jump;
    } else {
        const auto n = std::clamp<std::ptrdiff_t>(std::lround(in_frames) - 1, 0, time.frames - 1);
        r.instant = depth.frames[static_cast<std::size_t>(n)];
        if (std::abs(time.frame_s(n) - at) > 1e-6 * time.interval_s)
            r.instant_note = fmt::format("frame at {:g} ms", time.frame_s(n) * 1e3);
    }
    for (std::ptrdiff_t n = 0;
         within && n < time.frames && time.frame_s(n) <= at * (1.0 + time_slack); ++n)
        r.peak_m = std::fmax(r.peak_m, depth.frames[static_cast<std::size_t>(n)].peak);
    if (window.fits()) {
        r.weights = window_weights(time, window.from_s, window.to_s, window.edge_s);
        r.period = period_sums(depth.frames, r.weights);
    }
    return r;
}

/// Collects columns and ensures that every empty cell has a reason.
class Columns {
public:
    explicit Columns(std::vector<Detail> details) : details_(std::move(details)) {}

    /// `name` as in the table of measures.
    void add(std::string_view name, double value, std::string note,
             const std::vector<Detail>& more = {}) {
        if (!std::isfinite(value)) {
            value = not_a_number;
            if (note.empty()) note = "nothing has moved";
        }
        std::vector<Detail> details = details_;
        details.insert(details.end(), more.begin(), more.end());
        Column column = column_of(name, value, details);
        column.note = std::move(note);
        if (!depth_.empty()) {
            column.name += fmt::format("_z{}mm", depth_);
            column.long_name += fmt::format(", at {} mm depth", depth_);
        }
        all_.push_back(std::move(column));
    }
    /// Subsequent columns refer to this depth below the surface.
    void at_depth(double depth_m) { depth_ = fmt::format("{:g}", depth_m * 1e3); }
    std::vector<Column> take() { return std::move(all_); }

private:
    std::vector<Detail> details_;
    std::string depth_;
    std::vector<Column> all_;
};

void add_efficiency_of_period(Columns& columns, const Readings& r) {
    columns.add("eta_period_1", r.period ? reconstruction_efficiency(*r.period) : not_a_number,
                r.period_note);
}

/// One measure of spread: at the instant and over the period, as a count and as an area.
template <class Count>
void add_spread(Columns& columns, const Case& c, const Readings& r, const std::string& name,
                Count measure) {
    const double cell_mm2 = c.domain.spacing_m * c.domain.spacing_m * 1e6;
    const auto add = [&](const char* reading, double count, const std::string& note) {
        columns.add(name + reading + "_1", count, note);
        columns.add(name + reading + "_mm2", count * cell_mm2, note);
    };
    add("_at", r.instant ? measure(*r.instant) : not_a_number, r.instant_note);
    add("_period", r.period ? measure(*r.period) : not_a_number, r.period_note);
}

void add_peak(Columns& columns, const Readings& r) {
    std::string note;
    if (std::isnan(r.peak_m))
        note = r.instant_note.empty() ? "no frame up to the instant" : r.instant_note;
    columns.add("peak_um", r.peak_m * 1e6, note);
}

void add_focal_rms(Columns& columns, const Case& c, const Readings& r,
                   std::span<const SurfaceSums> frames) {
    double value = not_a_number;
    std::string note = r.period_note;
    if (r.period) {
        value = std::sqrt(r.period->focal_u2 / r.period->focal_weight) * 1e6;
        const double inside = focal_share(c, frames, r.weights);
        if (std::isnan(value))
            note = "the focal disc is not inside the measured region";
        else if (inside < 1.0 - 1e-9)
            note =
                fmt::format("{:.3g} % of the focal disc, on average over the window, lies outside "
                            "the measured region and is left out",
                            100.0 * (1.0 - inside));
    }
    columns.add("focal_rms_um", value, note);
}

void add_surface(Columns& columns, const Case& c, const Readings& r,
                 std::span<const SurfaceSums> frames) {
    columns.add("eta_at_1", r.instant ? reconstruction_efficiency(*r.instant) : not_a_number,
                r.instant_note);
    add_efficiency_of_period(columns, r);
    add_spread(columns, c, r, "ipr", [](const auto& sums) { return ipr(sums); });
    add_spread(columns, c, r, "ipr_abs", [](const auto& sums) { return ipr_abs(sums); });
    add_spread(columns, c, r, "participation",
               [](const auto& sums) { return participation(sums); });
    add_peak(columns, r);
    add_focal_rms(columns, c, r, frames);
}

void add_impulse(Columns& columns, const Case& c) {
    columns.add("impulse_mN_ms", impulse_N_s(c.scene.load, c.measure.at_s) * 1e6, "");
}

struct Band {
    const char* column;
    double low_Hz, high_Hz;
};
constexpr std::array<Band, 3> bands = {
    {{"rms_40_400_um", 40.0, 400.0}, {"rms_5_300_um", 5.0, 300.0}, {"rms_5_800_um", 5.0, 800.0}}};

/// The trace whose spectrum is measured, and its columns.
class SpectrumColumns {
public:
    SpectrumColumns(Columns& columns, const Case& c, const std::vector<TraceSeries>& traces)
        : columns_(columns), time_(c.time) {
        auto trace = std::ranges::find(traces, Vec2{}, &TraceSeries::at_m);
        if (trace == traces.end()) trace = traces.begin();
        if (traces.empty() || trace->u_m.empty()) {
            note_ = "no trace recorded";
            return;
        }
        where_ = {{"place", fmt::format("({:g}, {:g})", trace->at_m.x * 1e3, trace->at_m.y * 1e3)}};
        displacement_ = trace->u_m;
        velocity_ = differences(time_, trace->u_m);
    }

    std::span<const double> displacement() const { return displacement_; }
    std::span<const double> velocity() const { return velocity_; }

    void add_peak(const char* name, std::span<const double> values, bool has_mean) {
        double peak_Hz = not_a_number;
        std::string reason = note_;
        if (note_.empty()) {
            const double dt_s = time_.interval_s, duration_s = time_.duration_s();
            const std::vector<double> frequencies = trace_frequencies_Hz(time_);
            const auto amplitudes = amplitude_spectrum(values, dt_s, frequencies);
            peak_Hz = is_periodic() ? strongest_line_Hz(frequencies, amplitudes)
                                    : peak_frequency_Hz(frequencies, amplitudes, 1.0 / duration_s);
            if (!is_periodic() && has_mean) {
                // The mean of a run of finite length leaks to all frequencies. Removing it makes a
                // maximum of its own below 2/T.
                const double rest_Hz = peak_frequency_Hz(
                    frequencies, amplitude_spectrum(without_mean(values), dt_s, frequencies),
                    1.0 / duration_s);
                if (rest_Hz >= 2.0 / duration_s) peak_Hz = rest_Hz;
            }
            if (std::isnan(peak_Hz) && !is_periodic())
                reason = fmt::format("the spectrum is largest at the edge of the range: no peak "
                                     "between {:.3g} and {:.4g} Hz",
                                     1.0 / duration_s, std::min(frequencies.back(), 0.5 / dt_s));
        }
        columns_.add(name, peak_Hz, reason, where_);
    }
    void add_rms(const Band& band) {
        const std::string reason = missing_reason(band.high_Hz);
        columns_.add(band.column,
                     reason.empty()
                         ? rms_between(time_, displacement_, {band.low_Hz, band.high_Hz}) * 1e6
                         : not_a_number,
                     reason, where_);
    }
    void add_share(const char* name, std::span<const double> values, const FrequencyBand& band) {
        const std::string reason = missing_reason(band.high_Hz);
        double share = not_a_number;
        if (reason.empty()) {
            const ShareBands of = share_bands(time_, band);
            share = std::pow(
                rms_between(time_, values, of.part) / rms_between(time_, values, of.total), 2);
        }
        std::vector<Detail> details = where_;
        details.emplace_back("low", fmt::format("{:g}", band.low_Hz));
        details.emplace_back("high", fmt::format("{:g}", band.high_Hz));
        columns_.add(name, share, reason, details);
    }

private:
    static std::vector<double> without_mean(std::span<const double> values) {
        std::vector<double> rest(values.begin(), values.end());
        const double mean =
            std::reduce(rest.begin(), rest.end()) / static_cast<double>(rest.size());
        for (double& value : rest)
            value -= mean;
        return rest;
    }
    bool is_periodic() const { return time_.regime == Regime::periodic; }
    std::string missing_reason(double high_Hz) const {
        if (!note_.empty() || high_Hz <= 0.5 / time_.interval_s) return note_;
        return fmt::format("frames every {:g} us cannot represent {:g} Hz", time_.interval_s * 1e6,
                           high_Hz);
    }

    Columns& columns_;
    TimeAxis time_;
    std::string note_; // why there is no trace
    std::vector<Detail> where_;
    std::span<const double> displacement_;
    std::vector<double> velocity_;
};

void add_spectrum(Columns& columns, const Case& c, const std::vector<TraceSeries>& traces) {
    SpectrumColumns spectrum(columns, c, traces);
    spectrum.add_peak("peak_frequency_Hz", spectrum.displacement(), true);
    spectrum.add_peak("velocity_peak_frequency_Hz", spectrum.velocity(), false);
    for (const Band& band : bands)
        spectrum.add_rms(band);
    for (const FrequencyBand& band : c.measure.bands)
        spectrum.add_share("share_{low}_{high}_1", spectrum.displacement(), band);
    for (const FrequencyBand& band : c.measure.bands)
        spectrum.add_share("velocity_share_{low}_{high}_1", spectrum.velocity(), band);
}

void add_mach(Columns& columns, const Case& c, const std::optional<MachFit>& mach) {
    columns.add("mach_angle_deg", mach ? mach->angle_deg : not_a_number,
                mach ? mach->reason : "no surface frame was fitted");

    const Trajectory& trajectory = c.scene.load.modulation.trajectory;
    const double at = c.measure.at_s, speed = norm(velocity(trajectory, at));
    double theory = not_a_number;
    std::string note;
    if (!(speed > 0.0)) {
        note = "the focus does not move";
    } else if (const std::string none = no_focus_reason(c.measure, c.time, off_time_s(trajectory));
               !none.empty()) {
        note = none;
    } else if (!has_constant_velocity(trajectory) || c.scene.load.modulation.foci_m.size() > 1) {
        note = "the wake has no single angle: this requires a single focus that moves along a "
               "straight line at constant speed";
    } else if (c.scene.medium.layers.empty()) {
        note = "no layer";
    } else {
        try {
            const double rayleigh = rayleigh_speed_m_s(
                surface_wave_layer(c.scene.medium, fwhm_m(c.scene.load.footprint)));
            theory = mach_angle_theory_deg(rayleigh, speed);
            if (std::isnan(theory))
                note = fmt::format("{:.3g} m/s is not faster than the Rayleigh wave, {:.3g} m/s",
                                   speed, rayleigh);
        } catch (const Error& e) {
            note = e.what();
        }
    }
    columns.add("mach_angle_theory_deg", theory, note);
}

void add_sharpness(Columns& columns, const Case& c, const PeriodWindow& window,
                   const std::vector<double>& mean_u2) {
    const double fwhm = fwhm_m(c.scene.load.footprint);
    double value = not_a_number;
    std::string note = window.reason;
    if (note.empty() && mean_u2.empty()) note = "no mean energy was recorded";
    // Steps of a quarter of a sample shorten curves by less than a hundredth of one.
    if (note.empty())
        value = sharpness({mean_u2.data(), c.domain.nx, c.domain.ny}, c.domain,
                          measured_region(c.domain, c.measure),
                          drawn_shape(c.scene.load.modulation, 0.25 * c.domain.spacing_m), fwhm);
    columns.add("sharpness_1", value, note);
}

/// The area and the bounding box of a stated region, as far as it is measured.
void add_region(Columns& columns, const Case& c) {
    if (c.measure.region_m.empty()) return;
    const Region region = measured_region(c.domain, c.measure);
    const char* note = region.samples() > 0 ? "" : "the region contains no sample";
    const auto add = [&](const char* name, double value) {
        columns.add(name, *note ? not_a_number : value, note);
    };
    Vec2 low{not_a_number, not_a_number}, high = low;
    for (const Vec2 corner : measured_outline(c.domain, c.measure)) {
        low = {std::fmin(low.x, corner.x), std::fmin(low.y, corner.y)};
        high = {std::fmax(high.x, corner.x), std::fmax(high.y, corner.y)};
    }
    const double cell_mm = c.domain.spacing_m * 1e3;
    add("region_mm2", region.cells() * cell_mm * cell_mm);
    add("region_from_x_mm", low.x * 1e3);
    add("region_to_x_mm", high.x * 1e3);
    add("region_from_y_mm", low.y * 1e3);
    add("region_to_y_mm", high.y * 1e3);
}

} // namespace

std::vector<Column> summarise(const Case& c, const std::vector<DepthSeries>& depths,
                              const std::vector<TraceSeries>& traces,
                              const std::optional<MachFit>& mach,
                              const std::vector<double>& mean_u2) {
    const PeriodWindow window =
        period_window(c.measure, c.time, modulation_frequency_Hz(c.scene.load.modulation),
                      off_time_s(c.scene.load.modulation.trajectory));
    Readings surface{.instant_note = "no depth recorded", .period_note = "no depth recorded"};
    if (!depths.empty()) surface = read(c, window, depths.front());

    Columns columns({{"radius", fmt::format("{:g}", c.measure.focal_radius_m * 1e3)},
                     {"fwhm", fmt::format("{:g}", fwhm_m(c.scene.load.footprint) * 1e3)}});
    add_surface(columns, c, surface,
                depths.empty() ? std::span<const SurfaceSums>{} : depths.front().frames);
    add_impulse(columns, c);
    add_spectrum(columns, c, traces);
    add_mach(columns, c, mach);
    add_sharpness(columns, c, window, mean_u2);
    columns.add("periods", window.fits() ? window.periods : not_a_number, window.reason);
    add_region(columns, c);

    for (std::size_t d = 1; d < depths.size(); ++d) {
        const Readings below = read(c, window, depths[d]);
        columns.at_depth(depths[d].depth_m);
        add_efficiency_of_period(columns, below);
        add_focal_rms(columns, c, below, depths[d].frames);
        add_peak(columns, below);
    }
    return columns.take();
}

} // namespace shearwake::measures
