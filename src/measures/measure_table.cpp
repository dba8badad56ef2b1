// SPDX-License-Identifier: BSD-3-Clause
#include "measures/measure_table.hpp"

#include "base/error.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/summary.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

namespace shearwake::measures {
namespace {

// In the order of the report and of the short table.
constexpr std::array measures = {
    Measure{"eta_at_1", "1",
            "fraction of sum u_z^2 inside the focal disc[ of radius {radius} mm], at the instant",
            Shown::headlines},
    Measure{"eta_period_1", "1",
            "fraction of sum u_z^2 inside the focal disc[ of radius {radius} mm], over whole "
            "modulation periods",
            Shown::headlines},
    Measure{.name = "eta_period_over_reference_1",
            .unit = "1",
            .meaning = "eta_period_1 divided by that of the reference",
            .shown = Shown::headlines,
            .over_reference_of = "eta_period_1"},
    Measure{.name = "ipr_at_1",
            .unit = "1",
            .meaning = "(sum u_z)^2 / sum u_z^2, at the instant, in samples",
            .shown = Shown::headlines,
            .counts = Counts::samples},
    Measure{"ipr_at_mm2", "mm2", "(sum u_z)^2 / sum u_z^2, at the instant, as an area"},
    Measure{.name = "ipr_period_1",
            .unit = "1",
            .meaning = "(sum u_z)^2 / sum u_z^2, over whole modulation periods, in samples",
            .shown = Shown::headlines,
            .counts = Counts::samples},
    Measure{"ipr_period_mm2", "mm2",
            "(sum u_z)^2 / sum u_z^2, over whole modulation periods, as an area"},
    Measure{.name = "ipr_abs_at_1",
            .unit = "1",
            .meaning = "(sum |u_z|)^2 / sum u_z^2, at the instant, in samples",
            .counts = Counts::samples},
    Measure{"ipr_abs_at_mm2", "mm2", "(sum |u_z|)^2 / sum u_z^2, at the instant, as an area"},
    Measure{.name = "ipr_abs_period_1",
            .unit = "1",
            .meaning = "(sum |u_z|)^2 / sum u_z^2, over whole modulation periods, in samples",
            .counts = Counts::samples},
    Measure{"ipr_abs_period_mm2", "mm2",
            "(sum |u_z|)^2 / sum u_z^2, over whole modulation periods, as an area",
            Shown::headlines},
    Measure{.name = "participation_at_1",
            .unit = "1",
            .meaning = "(sum u_z^2)^2 / sum u_z^4, at the instant, in samples",
            .counts = Counts::samples},
    Measure{"participation_at_mm2", "mm2", "(sum u_z^2)^2 / sum u_z^4, at the instant, as an area"},
    Measure{.name = "participation_period_1",
            .unit = "1",
            .meaning = "(sum u_z^2)^2 / sum u_z^4, over whole modulation periods, in samples",
            .counts = Counts::samples},
    Measure{"participation_period_mm2", "mm2",
            "(sum u_z^2)^2 / sum u_z^4, over whole modulation periods, as an area",
            Shown::headlines},
    Measure{"peak_um", "um", "largest |u_z| of any frame up to the instant", Shown::headlines},
    Measure{"focal_rms_um", "um",
            "rms of u_z over the focal disc, where it lies inside the measured region, and whole "
            "modulation periods",
            Shown::headlines},
    Measure{.name = "focal_rms_over_reference_1",
            .unit = "1",
            .meaning = "focal_rms_um divided by that of the reference",
            .shown = Shown::headlines,
            .over_reference_of = "focal_rms_um"},
    Measure{"impulse_mN_ms", "mN ms", "time integral of the force up to the instant",
            Shown::headlines},
    Measure{"peak_frequency_Hz", "Hz",
            "frequency of the largest spectral amplitude[, u_z at {place} mm]", Shown::headlines},
    Measure{"velocity_peak_frequency_Hz", "Hz",
            "frequency of the largest spectral amplitude of du_z/dt[, u_z at {place} mm]"},
    Measure{"rms_40_400_um", "um",
            "rms over the run between 40 and 400 Hz, the range of perceptible vibration[, u_z at "
            "{place} mm]",
            Shown::headlines},
    Measure{"rms_5_300_um", "um",
            "rms over the run between 5 and 300 Hz, the band of RA (FA1) receptors[, u_z at "
            "{place} mm]"},
    Measure{"rms_5_800_um", "um",
            "rms over the run between 5 and 800 Hz, the band of PC (FA2) receptors[, u_z at "
            "{place} mm]"},
    Measure{"mach_angle_deg", "degree", "half-angle of the Mach cone, fitted to the surface",
            Shown::headlines},
    Measure{"mach_angle_theory_deg", "degree",
            "asin of the Rayleigh speed divided by the scan speed; the Rayleigh speed is that of "
            "the first layer thicker than a quarter of the footprint"},
    Measure{"share_{low}_{high}_1", "1",
            "fraction of the spectral energy above 1/T between {low} and {high} Hz, where T is the "
            "duration[, u_z at {place} mm]",
            Shown::page},
    Measure{"velocity_share_{low}_{high}_1", "1",
            "fraction of the spectral energy of du_z/dt above 1/T between {low} and {high} Hz, "
            "where T is the duration[, u_z at {place} mm]",
            Shown::page},
    Measure{"sharpness_1", "1",
            "fraction of the mean of u_z^2 within one FWHM[, {fwhm} mm,] of the drawn shape",
            Shown::shapes},
    Measure{"felt_peak_dB", "dB",
            "largest level of the acceleration of the skin above the threshold of perception",
            Shown::headlines},
    Measure{"felt_path_dB", "dB", "mean of the level over the drawn shape", Shown::headlines},
    Measure{"felt_band_Hz", "Hz",
            "third octave that decides the largest level; up to 40 Hz RA receptors respond, above "
            "PC",
            Shown::headlines},
    Measure{"felt_area_mm2", "mm2", "area in which the level is above 0 dB", Shown::headlines},
    Measure{"felt_width_mm", "mm",
            "width across the drawn shape in which the level is at most one just noticeable "
            "difference, 2.3 dB, below its maximum",
            Shown::page},
    Measure{"felt_width_low_mm", "mm", "felt_width_mm with a difference of 1.65 dB"},
    Measure{"felt_width_high_mm", "mm", "felt_width_mm with a difference of 2.98 dB"},
    Measure{"felt_contrast_dB", "dB",
            "mean of the level on the drawn shape, minus its mean farther than two FWHM from it",
            Shown::page},
    Measure{"felt_on_path_1", "1",
            "fraction within one FWHM of the drawn shape of the area whose level is less than 6 dB "
            "below the largest one",
            Shown::page},
    Measure{"felt_peaks_1", "1",
            "number of maxima of the level along sensation.line_mm that rise at least 2.3 dB above "
            "the saddles between them",
            Shown::page},
    Measure{"felt_gap_dB", "dB",
            "depth of the dip of the level between the two highest maxima along "
            "sensation.line_mm; 0: there is no second one",
            Shown::page},
    Measure{"felt_peak_sum_dB", "dB",
            "largest level, defined as the sum of the power of all third octaves, each relative to "
            "its threshold, instead of the largest"},
    Measure{"felt_path_sum_dB", "dB", "mean over the drawn shape of the level defined by that sum"},
    Measure{"periods", "1", "number of whole modulation periods in the window; 0: no modulation"},
    Measure{"region_mm2", "mm2",
            "area of the region in which the measures are taken (measure.region_mm)", Shown::page},
    Measure{"region_from_x_mm", "mm", "smallest x of the edge of the measured region", Shown::page},
    Measure{"region_to_x_mm", "mm", "largest x of the edge of the measured region", Shown::page},
    Measure{"region_from_y_mm", "mm", "smallest y of the edge of the measured region", Shown::page},
    Measure{"region_to_y_mm", "mm", "largest y of the edge of the measured region", Shown::page},
    Measure{"period_work_uJ", "uJ", "work of the load per period"},
    Measure{"period_absorbed_uJ", "uJ",
            "energy that viscosity absorbs per period in the layers of finite thickness, on the "
            "infinite plane"},
    Measure{"period_radiated_uJ", "uJ",
            "energy per period that leaves the layers of finite thickness for the half-space below "
            "them, on the infinite plane"},
    Measure{"receptor_periods_1", "1",
            "number of periods of the load in which the spikes of afferents count"},
    Measure{"receptor_run_in_periods_1", "1",
            "number of periods of the load before them, after which the response no longer depends "
            "on its start"},
    Measure{"{class}_spikes_1", "1", "number of spikes of all {class} afferents"},
    Measure{"{class}_active_1", "1", "number of {class} afferents that fire", Shown::headlines},
    Measure{"{class}_total_rate_Hz", "Hz", "spikes per second of all {class} afferents together",
            Shown::headlines},
    Measure{"{class}_peak_rate_Hz", "Hz",
            "spikes per second of all {class} afferents together in the 50 ms with most spikes",
            Shown::headlines},
    Measure{"{class}_near_path_1", "1",
            "fraction of the {class} spikes whose receptors are at most "
            "measure.focal_radius_mm from the path of the focus",
            Shown::headlines},
    Measure{"{class}_rate_Hz", "Hz", "mean rate of the {class} afferents that fire"},
    Measure{"{class}_spread_mm", "mm", "rms distance of {class} spikes from the path of the focus"},
    Measure{"{class}_vector_strength_1", "1",
            "vector strength of {class} spikes at the modulation frequency, averaged over the "
            "afferents that fire at least twice, weighted by their spikes"},
    Measure{"{class}_locking_1", "1",
            "vector strength of {class} spikes at the modulation frequency without the "
            "contribution of chance: root of the mean over afferents with five spikes or more, "
            "weighted by their pairs of spikes"},
    Measure{"{class}_first_spike_ms", "ms", "time of the first {class} spike"},
};

constexpr std::array series = {
    FrameMeasure{"eta", "1",
                 "reconstruction efficiency: fraction of sum u_z^2 within the focal disc",
                 [](const SurfaceSums& s) { return reconstruction_efficiency(s); }},
    FrameMeasure{"ipr", "1", "inverse participation ratio (sum u_z)^2 / sum u_z^2, samples",
                 [](const SurfaceSums& s) { return ipr(s); }},
    FrameMeasure{"ipr_abs", "1", "(sum |u_z|)^2 / sum u_z^2, samples",
                 [](const SurfaceSums& s) { return ipr_abs(s); }},
    FrameMeasure{"participation", "1", "(sum u_z^2)^2 / sum u_z^4, samples",
                 [](const SurfaceSums& s) { return participation(s); }},
    FrameMeasure{"peak", "m", "largest |u_z| in the measured region",
                 [](const SurfaceSums& s) { return s.peak; }},
    FrameMeasure{"focal_rms", "m",
                 "area-weighted rms of u_z over the focal disc inside the measured region",
                 [](const SurfaceSums& s) { return std::sqrt(s.focal_u2 / s.focal_weight); }},
    FrameMeasure{"sum_u", "m", "sum u_z", [](const SurfaceSums& s) { return s.u; }},
    FrameMeasure{"sum_abs_u", "m", "sum |u_z|", [](const SurfaceSums& s) { return s.abs_u; }},
    FrameMeasure{"sum_u2", "m2", "sum u_z^2", [](const SurfaceSums& s) { return s.u2; }},
    FrameMeasure{"sum_u4", "m4", "sum u_z^4", [](const SurfaceSums& s) { return s.u4; }},
    FrameMeasure{"focal_sum_u2", "m2", "sum w u_z^2 over the focal disc",
                 [](const SurfaceSums& s) { return s.focal_u2; }},
    FrameMeasure{"focal_weight", "1", "sum w over the focal disc, samples",
                 [](const SurfaceSums& s) { return s.focal_weight; }},
};

/// Whether `column` is `name` with values substituted for all {...}.
bool matches(std::string_view name, std::string_view column) {
    const std::size_t open = name.find('{');
    if (open == std::string_view::npos) return name == column;
    if (column.substr(0, open) != name.substr(0, open)) return false;
    const std::string_view rest = name.substr(name.find('}') + 1);
    for (std::size_t end = open + 1; end <= column.size(); ++end)
        if (matches(rest, column.substr(end))) return true;
    return false;
}

/// "focal_rms_um" of "focal_rms_um_z1.5mm".
std::string_view without_depth(std::string_view column) {
    const std::size_t suffix = column.rfind("_z");
    const bool has_one =
        suffix != std::string_view::npos && column.ends_with("mm") &&
        column.substr(suffix + 2).find_first_not_of("0123456789.e-+m") == std::string_view::npos;
    return has_one ? column.substr(0, suffix) : column;
}

/// Substitutes details for braces; nothing if a detail is missing.
std::optional<std::string> filled(std::string_view text, std::span<const Detail> details) {
    std::string out;
    while (!text.empty()) {
        const std::size_t open = text.find('{');
        out += text.substr(0, open);
        if (open == std::string_view::npos) break;
        const std::size_t close = text.find('}', open);
        const std::string_view name = text.substr(open + 1, close - open - 1);
        const auto found = std::ranges::find(details, name, &Detail::first);
        if (found == details.end()) return std::nullopt;
        out += found->second;
        text.remove_prefix(close + 1);
    }
    return out;
}

} // namespace

std::span<const Measure> all_measures() {
    return measures;
}

std::span<const FrameMeasure> frame_measures() {
    return series;
}

bool is_at_instant(std::string_view column) {
    return column.find("_at_") != std::string_view::npos;
}

bool counts_samples(std::string_view column) {
    const Measure* measure = find_measure(column);
    return measure && measure->counts == Counts::samples;
}

const Measure* find_measure(std::string_view column) {
    for (const std::string_view name : {column, without_depth(column)})
        for (const Measure& measure : measures)
            if (matches(measure.name, name)) return &measure;
    return nullptr;
}

std::string with_details(std::string_view text, std::span<const Detail> details) {
    std::string out;
    while (!text.empty()) {
        const std::size_t open = text.find('['), close = text.find(']');
        const std::string_view plain = text.substr(0, open);
        out += filled(plain, details).value_or(std::string(plain));
        if (open == std::string_view::npos) break;
        out += filled(text.substr(open + 1, close - open - 1), details).value_or("");
        text.remove_prefix(close + 1);
    }
    return out;
}

std::string column_reference() {
    std::string text = "| column | unit | meaning |\n|---|---|---|\n";
    for (const Measure& measure : measures) {
        std::string meaning;
        for (const char c : with_details(measure.meaning, {}))
            meaning += c == '|' ? std::string("\\|") : std::string(1, c);
        text += fmt::format("| `{}` | {} | {} |\n", measure.name, measure.unit, meaning);
    }
    return text;
}

Column column_of(std::string_view name, double value, std::span<const Detail> details) {
    const auto known = std::ranges::find(all_measures(), name, &Measure::name);
    if (known == all_measures().end())
        throw Error(fmt::format("{} is not in the table of measures", name));
    return {.name = with_details(known->name, details),
            .unit = known->unit,
            .long_name = with_details(known->meaning, details),
            .value = value,
            .note = ""};
}

} // namespace shearwake::measures
