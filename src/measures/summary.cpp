#include "measures/summary.hpp"

#include "base/error.hpp"
#include "measures/intensity.hpp"
#include "measures/participation.hpp"
#include "measures/period_sums.hpp"
#include "measures/reconstruction_efficiency.hpp"
#include "measures/sharpness.hpp"
#include "measures/spectrum.hpp"
#include "measures/window.hpp"
#include "model/drawn_shape.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace shearwake {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double slack = 1e-9; // of a time, for rounding

/// The same quantity at an instant and over the period window, as far as there are any.
struct Readings {
    std::optional<SurfaceSums> instant;
    std::string instant_note; // why there is none, or which frame stands in
    std::optional<PeriodSums> period;
    std::string period_note;
    double peak_m = nan; // largest |u| of any frame up to the instant
};

Readings read(const Case& c, const PeriodWindow& window, const DepthSeries& depth) {
    const TimeAxis& time = c.time;
    if (static_cast<std::ptrdiff_t>(depth.frames.size()) != time.frames)
        throw Error(fmt::format("{} frames of sums at depth {:g} mm, but the run has {}",
                                depth.frames.size(), depth.depth_m * 1e3, time.frames));
    Readings r;
    const double at = c.measure.at_s, in_frames = at / time.interval_s;
    if (at > time.duration_s() * (1.0 + slack)) {
        r.instant_note = fmt::format("{:g} ms lies beyond the run of {:g} ms", at * 1e3,
                                     time.duration_s() * 1e3);
    } else if (in_frames < 0.5) {
        r.instant_note = "at the start nothing has moved";
    } else if (const std::string none =
                   no_focus_reason(c.measure, time, off_time_s(c.load.modulation.trajectory));
               !none.empty()) {
        r.instant_note = none;
    } else {
        const auto n = std::clamp<std::ptrdiff_t>(std::lround(in_frames) - 1, 0, time.frames - 1);
        r.instant = depth.frames[static_cast<std::size_t>(n)];
        if (std::abs(time.frame_s(n) - at) > 1e-6 * time.interval_s)
            r.instant_note = fmt::format("frame at {:g} ms", time.frame_s(n) * 1e3);
    }
    const bool within = at <= time.duration_s() * (1.0 + slack);
    for (std::ptrdiff_t n = 0; within && n < time.frames && time.frame_s(n) <= at * (1.0 + slack);
         ++n) {
        const double peak = depth.frames[static_cast<std::size_t>(n)].peak;
        r.peak_m = std::isnan(r.peak_m) ? peak : std::max(r.peak_m, peak);
    }
    if (window.fits())
        r.period = period_sums(depth.frames, window_weights(time, window.from_s, window.to_s));
    r.period_note = window.reason;
    return r;
}

/// Collects columns, and sees to it that an empty cell says why.
class Columns {
public:
    void add(std::string name, std::string unit, std::string long_name, double value,
             std::string note) {
        if (!std::isfinite(value)) {
            value = nan;
            if (note.empty()) note = "nothing has moved";
        }
        all_.push_back(
            {std::move(name), std::move(unit), std::move(long_name), value, std::move(note)});
    }
    std::vector<Column> take() { return std::move(all_); }

private:
    std::vector<Column> all_;
};

void add_efficiency(Columns& columns, const Case& c, const Readings& r) {
    const std::string what =
        fmt::format("share of sum u_z^2 inside the focal disc of radius {:g} mm",
                    c.measure.focal_radius_m * 1e3);
    columns.add("eta_at_1", "1", what + ", at the instant",
                r.instant ? reconstruction_efficiency(*r.instant) : nan, r.instant_note);
    columns.add("eta_period_1", "1", what + ", over whole modulation periods",
                r.period ? reconstruction_efficiency(*r.period) : nan, r.period_note);
}

/// One measure of spread: at the instant and over the period, as a count and as an area.
template <class Measure>
void add_spread(Columns& columns, const Case& c, const Readings& r, const std::string& name,
                const std::string& what, Measure measure) {
    const double cell_mm2 = c.domain.spacing_m * c.domain.spacing_m * 1e6;
    const auto add = [&](const char* reading, const char* when, double count,
                         const std::string& note) {
        columns.add(name + reading + "_1", "1", what + when + ", in samples", count, note);
        columns.add(name + reading + "_mm2", "mm2", what + when + ", as an area", count * cell_mm2,
                    note);
    };
    add("_at", ", at the instant", r.instant ? measure(*r.instant) : nan, r.instant_note);
    add("_period", ", over whole modulation periods", r.period ? measure(*r.period) : nan,
        r.period_note);
}

void add_peak(Columns& columns, const Readings& r, const std::string& suffix,
              const std::string& where) {
    std::string note;
    if (std::isnan(r.peak_m))
        note = r.instant_note.empty() ? "no frame up to the instant" : r.instant_note;
    columns.add("peak_um" + suffix, "um", "largest |u_z| of any frame up to the instant" + where,
                r.peak_m * 1e6, note);
}

void add_focal_rms(Columns& columns, const Readings& r, const std::string& suffix,
                   const std::string& where) {
    double value = nan;
    std::string note = r.period_note;
    if (r.period) {
        value = std::sqrt(r.period->focal_mean_u2 / r.period->weight) * 1e6;
        if (std::isnan(value)) note = "the focal disc leaves the measured region";
    }
    columns.add("focal_rms_um" + suffix, "um",
                "rms of u_z over the focal disc and whole modulation periods" + where, value, note);
}

void add_surface(Columns& columns, const Case& c, const Readings& r) {
    add_efficiency(columns, c, r);
    add_spread(columns, c, r, "ipr", "(sum u_z)^2 / sum u_z^2",
               [](const auto& sums) { return ipr(sums); });
    add_spread(columns, c, r, "ipr_abs", "(sum |u_z|)^2 / sum u_z^2",
               [](const auto& sums) { return ipr_abs(sums); });
    add_spread(columns, c, r, "participation", "(sum u_z^2)^2 / sum u_z^4",
               [](const auto& sums) { return participation(sums); });
    add_peak(columns, r, "", "");
    add_focal_rms(columns, r, "", "");
}

void add_impulse(Columns& columns, const Case& c) {
    columns.add("impulse_mN_ms", "mN ms", "time integral of the force up to the instant",
                impulse_N_s(c.load, c.measure.at_s) * 1e6, "");
}

struct Band {
    double low_Hz, high_Hz;
    const char* what;
};
constexpr std::array<Band, 3> bands = {{{40.0, 400.0, "vibration that is felt"},
                                        {5.0, 300.0, "band of the FA1 receptors"},
                                        {5.0, 800.0, "band of the FA2 receptors"}}};

/// du/dt times the distance of the frames, from rest on.
std::vector<double> differences(std::span<const double> u) {
    std::vector<double> steps;
    double last = 0.0;
    for (const double value : u) {
        steps.push_back(value - last);
        last = value;
    }
    return steps;
}

void add_spectrum(Columns& columns, const Case& c, const std::vector<TraceSeries>& traces) {
    const auto at_origin = std::find_if(traces.begin(), traces.end(),
                                        [](const TraceSeries& t) { return t.at_m == Vec2{}; });
    const TraceSeries* trace = nullptr;
    if (at_origin != traces.end())
        trace = &*at_origin;
    else if (!traces.empty())
        trace = &traces.front();

    std::string note, where;
    if (!trace || trace->u_m.empty())
        note = "no trace recorded";
    else
        where = fmt::format(", u_z at ({:g}, {:g}) mm", trace->at_m.x * 1e3, trace->at_m.y * 1e3);
    const double dt = c.time.interval_s;

    const auto add_peak_of = [&](const std::string& name, const std::string& what,
                                 std::span<const double> values) {
        double peak_Hz = nan;
        std::string trouble = note;
        if (note.empty()) {
            const double duration = dt * static_cast<double>(values.size());
            const std::vector<double> frequencies = spectrum_frequencies_Hz(duration);
            peak_Hz = peak_frequency_Hz(frequencies, amplitude_spectrum(values, dt, frequencies),
                                        1.0 / duration);
            if (std::isnan(peak_Hz))
                trouble = fmt::format(
                    "the spectrum is largest at its edge: no peak between {:.3g} and 2000 Hz",
                    1.0 / duration);
        }
        columns.add(name, "Hz", what + where, peak_Hz, trouble);
    };
    const std::vector<double> velocity =
        note.empty() ? differences(trace->u_m) : std::vector<double>{};
    const std::span<const double> displacement =
        note.empty() ? std::span<const double>(trace->u_m) : std::span<const double>{};
    add_peak_of("peak_frequency_Hz", "frequency of the largest spectral amplitude", displacement);
    add_peak_of("velocity_peak_frequency_Hz",
                "frequency of the largest spectral amplitude of du_z/dt", velocity);

    const auto why_not = [&](double high_Hz) {
        if (!note.empty() || high_Hz <= 0.5 / dt) return note;
        return fmt::format("frames every {:g} us do not carry {:g} Hz", dt * 1e6, high_Hz);
    };
    for (const Band& band : bands) {
        const std::string trouble = why_not(band.high_Hz);
        columns.add(fmt::format("rms_{:g}_{:g}_um", band.low_Hz, band.high_Hz), "um",
                    fmt::format("rms over the run between {:g} and {:g} Hz, {}{}", band.low_Hz,
                                band.high_Hz, band.what, where),
                    trouble.empty() ? band_rms(trace->u_m, dt, band.low_Hz, band.high_Hz) * 1e6
                                    : nan,
                    trouble);
    }
    const auto add_shares = [&](const std::string& name, const std::string& what,
                                std::span<const double> values) {
        for (const FrequencyBand& band : c.measure.bands) {
            const std::string trouble = why_not(band.high_Hz);
            double share = nan;
            if (trouble.empty()) {
                const double duration_s = dt * static_cast<double>(values.size());
                const double low_Hz = std::max(band.low_Hz, 1.0 / duration_s);
                share = std::pow(band_rms(values, dt, low_Hz, std::max(low_Hz, band.high_Hz)) /
                                     band_rms(values, dt, 1.0 / duration_s, 0.5 / dt),
                                 2);
            }
            columns.add(fmt::format("{}_{:g}_{:g}_1", name, band.low_Hz, band.high_Hz), "1",
                        fmt::format("share of the energy{} above one period a run that lies "
                                    "between {:g} and {:g} Hz{}",
                                    what, band.low_Hz, band.high_Hz, where),
                        share, trouble);
        }
    };
    add_shares("share", "", displacement);
    add_shares("velocity_share", " of du_z/dt", velocity);
}

void add_mach(Columns& columns, const Case& c, const std::optional<MachFit>& mach) {
    columns.add("mach_angle_deg", "degree", "half-angle of the wake, fitted to the surface",
                mach ? mach->angle_deg : nan, mach ? mach->reason : "no surface frame was fitted");

    const Trajectory& trajectory = c.load.modulation.trajectory;
    const double at = c.measure.at_s, speed = norm(velocity(trajectory, at));
    double theory = nan;
    std::string note;
    if (!(speed > 0.0)) {
        note = "the focus does not move";
    } else if (const std::string none = no_focus_reason(c.measure, c.time, off_time_s(trajectory));
               !none.empty()) {
        note = none;
    } else if (!has_constant_velocity(trajectory) || c.load.modulation.foci_m.size() > 1) {
        note = "no single focus that runs straight on at one speed: the wake has no single angle";
    } else if (c.medium.layers.empty()) {
        note = "no layer";
    } else {
        try {
            const double rayleigh =
                rayleigh_speed_m_s(surface_wave_layer(c.medium, fwhm_m(c.load.footprint)));
            theory = mach_angle_theory_deg(rayleigh, speed);
            if (std::isnan(theory))
                note = fmt::format("{:.3g} m/s is not faster than the Rayleigh wave, {:.3g} m/s",
                                   speed, rayleigh);
        } catch (const Error& e) {
            note = e.what();
        }
    }
    columns.add("mach_angle_theory_deg", "degree",
                "asin of the Rayleigh speed over the scan speed, of the first layer thicker than a "
                "quarter of the footprint",
                theory, note);
}

void add_sharpness(Columns& columns, const Case& c, const PeriodWindow& window,
                   const std::vector<double>& mean_u2) {
    const double fwhm = fwhm_m(c.load.footprint);
    double value = nan;
    std::string note = window.reason;
    if (note.empty() && mean_u2.empty()) note = "no mean energy was kept";
    if (note.empty()) // steps of a quarter of a sample: cut curves by less than a 100th of one
        value = sharpness({mean_u2.data(), c.domain.nx, c.domain.ny}, c.domain,
                          measured_region(c.domain),
                          drawn_shape(c.load.modulation, 0.25 * c.domain.spacing_m), fwhm);
    columns.add(
        "sharpness_1", "1",
        fmt::format("share of the mean of u_z^2 within one FWHM, {:g} mm, of the drawn line",
                    fwhm * 1e3),
        value, note);
}

} // namespace

std::vector<Column> summarise(const Case& c, const std::vector<DepthSeries>& depths,
                              const std::vector<TraceSeries>& traces,
                              const std::optional<MachFit>& mach,
                              const std::vector<double>& mean_u2) {
    const PeriodWindow window =
        period_window(c.measure, c.time, modulation_frequency_Hz(c.load.modulation),
                      off_time_s(c.load.modulation.trajectory));
    Readings surface{.instant_note = "no depth recorded", .period_note = "no depth recorded"};
    if (!depths.empty()) surface = read(c, window, depths.front());

    Columns columns;
    add_surface(columns, c, surface);
    add_impulse(columns, c);
    add_spectrum(columns, c, traces);
    add_mach(columns, c, mach);
    add_sharpness(columns, c, window, mean_u2);
    columns.add("periods", "1", "whole modulation periods in the window; 0: no modulation",
                window.fits() ? window.periods : nan, window.reason);

    for (std::size_t d = 1; d < depths.size(); ++d) {
        const Readings below = read(c, window, depths[d]);
        const std::string depth = fmt::format("{:g} mm", depths[d].depth_m * 1e3);
        const std::string suffix = fmt::format("_z{:g}mm", depths[d].depth_m * 1e3);
        columns.add("eta_period_1" + suffix, "1",
                    "share of sum u_z^2 inside the focal disc, over whole modulation periods, at " +
                        depth + " depth",
                    below.period ? reconstruction_efficiency(*below.period) : nan,
                    below.period_note);
        add_focal_rms(columns, below, suffix, ", at " + depth + " depth");
        add_peak(columns, below, suffix, ", at " + depth + " depth");
    }
    return columns.take();
}

} // namespace shearwake
