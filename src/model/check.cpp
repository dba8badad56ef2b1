#include "model/check.hpp"

#include "model/check_study.hpp"
#include "model/check_variation.hpp"
#include "model/edge_absorption.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace shearwake {
namespace {

constexpr double two_pi = 2.0 * std::numbers::pi;
/// A footprint sampled below this many points a width is no footprint any more.
constexpr double least_points_per_fwhm = 1.5;
constexpr double good_points_per_fwhm = 3.0;
/// The share of the footprint's spectrum that may lie beyond what the grid carries.
constexpr double aliased_share = 1e-3;
/// Where the spectrum of the moving load is taken to end.
constexpr double spectrum_end = 1e-2;
/// A layer thinner than this carries no shear wave of its own across the domain.
constexpr double thin_layer_m = 1e-3;
/// The path is looked at this often at most: a fraction of a per mille of it is fine enough.
constexpr double most_samples = 4000.0;
/// The share of a wave's energy that a sponge may give back, and the sponge's width that does it,
/// in wavelengths (model/edge_absorption).
constexpr double tolerated_return = 0.01;
double width_for(double wavelength_m) {
    return wavelength_m / 1.65;
}

/// Collects what is said, with lengths in mm and times in ms as the job has them.
struct Notes {
    std::vector<Remark> remarks;

    template <class... Args>
    void add(Severity severity, const char* key, fmt::format_string<Args...> format,
             Args&&... args) {
        remarks.push_back({severity, key, fmt::format(format, std::forward<Args>(args)...)});
    }
};

double milli(double value) {
    return 1e3 * value;
}

/// How long the load is on within the run.
double loaded_s(const Case& c) {
    return std::min(c.time.duration_s(), off_time_s(c.load.modulation.trajectory));
}

/// Calls f(t, focus) for every focus along the path while the load is on, both ends included.
template <class F>
void along_path(const Case& c, F f) {
    const double end_s = loaded_s(c);
    const double step_s = std::max(c.time.interval_s, end_s / most_samples);
    const auto at = [&](double t_s) {
        for (const Vec2& focus : foci(c.load.modulation, t_s))
            f(t_s, focus);
    };
    for (double n = 0.0; n * step_s < end_s; ++n)
        at(n * step_s);
    at(end_s);
}

void check_focus_resolution(const Case& c, Notes& notes) {
    const double width_m = fwhm_m(c.load.footprint), spacing_m = c.domain.spacing_m;
    const double points = width_m / spacing_m;
    const double share = spectrum(c.load.footprint, std::numbers::pi / spacing_m, 0.0) /
                         spectrum(c.load.footprint, 0.0, 0.0);
    const double wanted_mm = milli(width_m) / good_points_per_fwhm;
    if (points < least_points_per_fwhm)
        notes.add(Severity::error, "domain.spacing_mm",
                  "the focus is {:.3g} mm wide (FWHM) and the spacing {:.3g} mm, {:.2g} points a "
                  "width: the grid does not see its shape; at most {:.3g} mm resolves it",
                  milli(width_m), milli(spacing_m), points, wanted_mm);
    else if (points < good_points_per_fwhm || share > aliased_share)
        notes.add(Severity::warning, "domain.spacing_mm",
                  "the focus is {:.3g} mm wide (FWHM) and the spacing {:.3g} mm, {:.2g} points a "
                  "width: {:.2g} of its spectrum's peak is left at the shortest shear wave the "
                  "grid carries; {:.3g} mm would do",
                  milli(width_m), milli(spacing_m), points, share, wanted_mm);
}

/// Frames further apart than half the load's shortest period do not follow it.
void check_sampling(const Case& c, Notes& notes) {
    const Modulation& modulation = c.load.modulation;
    const double interval_s = c.time.interval_s;
    const double passing_Hz = bandwidth_rad_m(c.load.footprint, spectrum_end) *
                              greatest_speed_m_s(modulation.trajectory) / two_pi;
    const double fastest_Hz = passing_Hz + greatest_envelope_frequency_Hz(modulation.envelope);
    if (fastest_Hz * interval_s > 0.5)
        notes.add(Severity::warning, "time.output_interval_us",
                  "the load reaches {:.4g} Hz and a frame every {:.4g} us follows it up to {:.4g} "
                  "Hz: frames alias; {:.3g} us would do",
                  fastest_Hz, 1e6 * interval_s, 0.5 / interval_s, 1e6 * 0.5 / fastest_Hz);
    const auto frequency_Hz = modulation_frequency_Hz(modulation);
    if (frequency_Hz && *frequency_Hz * interval_s > 0.25)
        notes.add(Severity::warning, "time.output_interval_us",
                  "the modulation of {:.4g} Hz has fewer than four frames a period of {:.4g} us; "
                  "{:.3g} us would do",
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
    const double margin_m = c.domain.sponge_m + 2.0 * fwhm_m(c.load.footprint);
    if (room_m < 0.0)
        notes.add(Severity::error, "domain.extent_mm",
                  "the focus leaves the domain: at {:.4g} ms it is at [{:.4g}, {:.4g}] mm, and the "
                  "domain ends at {:.4g} and {:.4g} mm",
                  milli(when_s), milli(nearest.x), milli(nearest.y), milli(half_x_m),
                  milli(half_y_m));
    else if (room_m < margin_m)
        notes.add(
            Severity::warning, "domain.extent_mm",
            "at {:.4g} ms the focus is at [{:.4g}, {:.4g}] mm, {:.4g} mm from the edge, which "
            "is less than the sponge and two focus widths, {:.4g} mm: the wake is cut off",
            milli(when_s), milli(nearest.x), milli(nearest.y), milli(room_m), milli(margin_m));
    const auto* array = std::get_if<ArrayFootprint>(&c.load.footprint);
    if (array && room_m >= margin_m && room_m < array->reach_m)
        notes.add(Severity::warning, "load.footprint",
                  "side lobes of the array are kept up to {:.4g} mm from the focus, which comes "
                  "within {:.4g} mm of the edge: there they press on the other side; a larger "
                  "domain or reach_mm = {:.0f} would avoid it",
                  milli(array->reach_m), milli(room_m), std::floor(milli(room_m)));
}

/// Shear waves cross the domain about as fast as in the fastest layer that is no mere film.
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

/// Whether the margin absorbs, and is not merely left out of the measures.
bool absorbs(const Case& c) {
    return c.domain.sponge_m > 0.0 && !std::holds_alternative<LayeredOptions>(c.solver);
}

/// Whether something around the domain absorbs, so that its edges are not periodic.
bool is_surrounded(const Case& c) {
    const auto* pstd = std::get_if<PstdOptions>(&c.solver);
    return pstd && pstd->absorbing_edges;
}

/// The domain is periodic: a wave that leaves at one edge enters at the other, unless a sponge
/// takes it; what a sponge lets through, check_sponge tells.
void check_wrap_around(const Case& c, Notes& notes) {
    if (absorbs(c) || is_surrounded(c)) return;
    const double speed_m_s = wave_speed_m_s(c.medium), end_s = c.time.duration_s();
    if (!(speed_m_s > 0.0)) return;
    const double half_x_m = 0.5 * c.domain.extent_x_m(), half_y_m = 0.5 * c.domain.extent_y_m();
    double back_s = end_s, needed_x_m = 0.0, needed_y_m = 0.0;
    along_path(c, [&](double t_s, Vec2 focus) {
        // The margin is not measured: a wave must cross it on the far side as well.
        const double edge_m = std::min(half_x_m - std::abs(focus.x), half_y_m - std::abs(focus.y));
        back_s = std::min(back_s, t_s + (edge_m + c.domain.sponge_m) / speed_m_s);
        const double reach_m = speed_m_s * (end_s - t_s) - c.domain.sponge_m;
        needed_x_m = std::max(needed_x_m, 2.0 * (std::abs(focus.x) + reach_m));
        needed_y_m = std::max(needed_y_m, 2.0 * (std::abs(focus.y) + reach_m));
    });
    const double out_s = back_s - c.domain.sponge_m / speed_m_s;
    const bool starts_outside = out_s < 0.0; // told elsewhere
    if (starts_outside || back_s >= end_s * (1.0 - 1e-9)) return;
    notes.add(
        Severity::warning, "domain.extent_mm",
        "waves of {:.4g} m/s that cross the edge at {:.3g} ms are back in the measured region "
        "on the other side at {:.3g} ms, before the run ends at {:.4g} ms; {:.0f} x {:.0f} mm "
        "would avoid it",
        speed_m_s, milli(out_s), milli(back_s), milli(end_s),
        std::ceil(milli(std::max(needed_x_m, c.domain.extent_x_m())) - 1e-6),
        std::ceil(milli(std::max(needed_y_m, c.domain.extent_y_m())) - 1e-6));
}

void check_sponge(const Case& c, Notes& notes) {
    const double width_m = c.domain.sponge_m;
    if (!(width_m > 0.0) || is_surrounded(c)) return;
    if (!absorbs(c)) {
        notes.add(Severity::warning, "domain.sponge_mm",
                  "the edges of the engine \"{}\" are periodic and absorb nothing: the margin "
                  "of {:.4g} mm is only kept out of the measures",
                  engine_name(c.solver), milli(width_m));
        return;
    }
    if (!std::holds_alternative<SpectralOptions>(c.solver)) return; // a layer of another kind
    const double wave_m = longest_wave_m(c.load, edge_speed_m_s(c.medium, width_m));
    const double share = returned_energy(wave_m, width_m);
    if (share > tolerated_return)
        notes.add(Severity::warning, "domain.sponge_mm",
                  "a margin of {:.4g} mm gives back {:.2g} % of the energy of the longest waves, "
                  "{:.3g} mm; {:.3g} mm would keep it below 1 %",
                  milli(width_m), 100.0 * share, milli(wave_m), milli(width_for(wave_m)));
}

/// What the engines do not compute.
void check_engine(const Case& c, Notes& notes) {
    const auto& fields = c.record.volume_fields;
    const bool more_than_u = std::any_of(fields.begin(), fields.end(),
                                         [](VolumeField f) { return f != VolumeField::u; });
    if (std::holds_alternative<LayeredOptions>(c.solver) && !c.record.volumes_s.empty())
        notes.add(Severity::error, "record.volumes_ms",
                  "asks for the field below the surface, which the engine \"{}\" does not "
                  "keep; solver.engine = \"spectral\" does",
                  engine_name(c.solver));
    if (std::holds_alternative<PstdOptions>(c.solver) && more_than_u)
        notes.add(Severity::error, "record.volume_fields",
                  "asks for more than the displacement \"u\", which is all that the engine "
                  "\"pstd\" keeps; solver.engine = \"spectral\" keeps strain and stress");
    if (std::holds_alternative<LayeredOptions>(c.solver)) return;
    if (std::holds_alternative<PstdOptions>(c.solver) &&
        !std::holds_alternative<GaussianFootprint>(c.load.footprint))
        notes.add(Severity::error, "load.footprint",
                  "the engine \"pstd\" takes Gaussian foci, and this is an array; \"layered\" and "
                  "\"spectral\" take both");
    for (const Layer& layer : c.medium.layers)
        if (!std::holds_alternative<Lossless>(layer.loss) &&
            !std::holds_alternative<KelvinVoigt>(layer.loss))
            notes.add(Severity::error, "solver.engine",
                      "\"{}\" takes layers that are lossless or Kelvin-Voigt (viscosity_Pa_s), "
                      "and layer \"{}\" is not; \"layered\" takes any law",
                      engine_name(c.solver), layer.name);
}

void check_measured_times(const Case& c, Notes& notes) {
    const double off_s = off_time_s(c.load.modulation.trajectory);
    if (off_s + c.time.interval_s < c.measure.at_s)
        notes.add(Severity::warning, "measure.at_ms",
                  "the path ends at {:.4g} ms, so that there is no load at {:.4g} ms", milli(off_s),
                  milli(c.measure.at_s));
    const auto frequency_Hz = modulation_frequency_Hz(c.load.modulation);
    const double window_s = c.measure.at_s - c.measure.settled_after_s;
    if (frequency_Hz && *frequency_Hz * window_s < 1.0 - 1e-9)
        notes.add(Severity::warning, "measure.settled_after_ms",
                  "a period of the modulation lasts {:.4g} ms and does not fit between {:.4g} and "
                  "{:.4g} ms: the period columns will be empty; settle earlier, or let "
                  "time.duration_ms and measure.at_ms be longer",
                  1e3 / *frequency_Hz, milli(c.measure.settled_after_s), milli(c.measure.at_s));
}

void check_focal_region(const Case& c, Notes& notes) {
    const double radius_m = c.measure.focal_radius_m;
    const double shorter_m = std::min(c.domain.extent_x_m(), c.domain.extent_y_m());
    if (radius_m < c.domain.spacing_m)
        notes.add(Severity::warning, "measure.focal_radius_mm",
                  "the focal region's radius of {:.3g} mm is below the spacing of {:.3g} mm: it "
                  "holds a sample or two",
                  milli(radius_m), milli(c.domain.spacing_m));
    else if (radius_m > 0.25 * shorter_m)
        notes.add(Severity::warning, "measure.focal_radius_mm",
                  "the focal region's radius of {:.4g} mm is more than a quarter of the domain's "
                  "shorter side, {:.4g} mm: eta says little",
                  milli(radius_m), milli(shorter_m));
}

} // namespace

std::vector<Remark> check(const Case& c) {
    Notes notes;
    const auto* pstd = std::get_if<PstdOptions>(&c.solver);
    if (pstd && pstd->study) { // neither medium nor load of the case drives anything
        if (const std::string trouble = study_trouble(c); !trouble.empty())
            notes.add(Severity::error, "solver.pstd.study", "{}", trouble);
        check_focal_region(c, notes);
        return notes.remarks;
    }
    check_focus_resolution(c, notes);
    check_sampling(c, notes);
    check_focus_in_domain(c, notes);
    check_wrap_around(c, notes);
    check_sponge(c, notes);
    check_engine(c, notes);
    check_measured_times(c, notes);
    check_focal_region(c, notes);
    for (Remark& remark : check_variation(c))
        notes.remarks.push_back(std::move(remark));
    return notes.remarks;
}

} // namespace shearwake
