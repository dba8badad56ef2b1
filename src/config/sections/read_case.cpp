// SPDX-License-Identifier: BSD-3-Clause
#include "config/sections/read_case.hpp"

#include "base/csv.hpp"
#include "base/text.hpp"
#include "config/document/presets.hpp"
#include "config/sections/read_fields.hpp"
#include "problem/load/load.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::config {
namespace {

constexpr double most_side_points = 32768.0; // along one side of the domain
constexpr double most_frames = 1e6;

/// The number of the frame at time t, counted from 1; nothing if t lies between two frames or
/// outside the run.
std::optional<double> frame_time_s(const TimeAxis& time, double t_s) {
    const double frame = std::round(t_s / time.interval_s);
    const bool on_frame = std::abs(t_s - frame * time.interval_s) <= 1e-6 * time.interval_s ||
                          std::abs(t_s - frame * time.interval_s) <= 1e-6 * t_s;
    const bool in_run = frame >= 1.0 && frame <= static_cast<double>(time.frames);
    return on_frame && in_run ? std::optional(frame * time.interval_s) : std::nullopt;
}

std::string off_frame_message(const TimeAxis& time, double t_s) {
    return fmt::format("must be the time of a frame: a multiple of time.output_interval_us = "
                       "{:.6g}, up to time.duration_ms = {}; {} is not",
                       1e6 * time.interval_s, in_milli(time.duration_s()), in_milli(t_s));
}

/// Whether no error has occurred since construction: only then are values compared with each other.
class NoNewErrors {
public:
    explicit NoNewErrors(const DiagnosticList& diagnostics)
        : diagnostics_(diagnostics), before_(diagnostics.errors()) {}
    explicit operator bool() const { return diagnostics_.errors() == before_; }

private:
    const DiagnosticList& diagnostics_;
    std::size_t before_;
};

std::ptrdiff_t points_along(const Reader& reader, double extent_m, double spacing_m) {
    const double points = std::ceil(extent_m / spacing_m - 1e-9);
    if (points <= most_side_points) return good_even_length(static_cast<std::ptrdiff_t>(points));
    reader.error("spacing_mm",
                 fmt::format("results in {:.0f} points along {} mm; at most {:.0f} are supported",
                             points, in_milli(extent_m), most_side_points));
    return 2;
}

void check_depths(const Reader& reader, const std::vector<double>& depths_m, const Medium& medium) {
    double total_m = 0.0;
    for (const Layer& layer : medium.layers)
        total_m += layer.thickness_m;
    for (std::size_t i = 0; i < depths_m.size(); ++i) {
        if (i > 0 && !(depths_m[i] > depths_m[i - 1]))
            reader.error("depths_mm",
                         fmt::format("must be in ascending order, but {} follows {}",
                                     in_milli(depths_m[i]), in_milli(depths_m[i - 1])));
        if (medium.base == Base::rigid && !medium.layers.empty() && depths_m[i] >= total_m)
            reader.error("depths_mm",
                         fmt::format("must lie above the rigid base at {} mm, but contains {}",
                                     in_milli(total_m), in_milli(depths_m[i])));
    }
}

/// Receptors with the input "stress" must lie inside the medium.
void check_receptor_depths(const Reader& reader, const Case& c) {
    double total_m = 0.0;
    for (const Layer& layer : c.scene.medium.layers)
        total_m += layer.thickness_m;
    if (c.scene.medium.base != Base::rigid || c.scene.medium.layers.empty()) return;
    for (const double depth_m : stress_depths_m(c))
        if (depth_m >= total_m) {
            reader.error("input", fmt::format("is \"stress\", but receptors at a depth of {} mm do "
                                              "not lie above the rigid base at {} mm",
                                              in_milli(depth_m), in_milli(total_m)));
            return;
        }
}

double read_focal_radius_m(Reader& reader, const Load& load) {
    const auto in_fwhm =
        reader.find_number("focal_radius_fwhm", range_of<MeasureOptions>("focal_radius_fwhm"));
    const auto radius_m =
        reader.find_number("focal_radius_mm", range_of<MeasureOptions>("focal_radius_mm"));
    if (reader.has("focal_radius_fwhm") && reader.has("focal_radius_mm"))
        reader.conflict("focal_radius_mm",
                        "and focal_radius_fwhm are both given; remove one of them from the job");
    return radius_m.value_or(in_fwhm.value_or(1.0) * fwhm_m(load.footprint));
}

} // namespace

Domain read_domain(Reader& reader) {
    if (reader.empty()) return {};
    const NoNewErrors no_new_errors(reader.diagnostics());
    Domain domain;
    const Vec2 extent_m = reader.point("extent_mm", range_of<Domain>("extent_mm"));
    read_fields(reader, domain);
    reader.finish();
    if (!no_new_errors) return domain;
    domain.nx = points_along(reader, extent_m.x, domain.spacing_m);
    domain.ny = points_along(reader, extent_m.y, domain.spacing_m);
    const double shorter_m = std::min(domain.extent_x_m(), domain.extent_y_m());
    if (no_new_errors && 2.0 * domain.sponge_m >= shorter_m)
        reader.error("sponge_mm",
                     fmt::format("must leave a measured region between the margins: it must be "
                                 "below {} mm, half of the shorter side, but is {}",
                                 in_milli(0.5 * shorter_m), in_milli(domain.sponge_m)));
    return domain;
}

namespace {

/// The frames of one period of the load.
void set_period(const Reader& reader, const Load& load, double longest_s, TimeAxis& time) {
    const LoadPeriod period = least_period(load, longest_s);
    if (!period.reason.empty()) {
        reader.error("regime", "is \"periodic\", but the load " + period.reason);
        return;
    }
    const double frames = std::ceil(period.period_s / time.interval_s - 1e-9);
    if (frames > most_frames)
        return reader.error("output_interval_us",
                            fmt::format("results in {:.0f} frames; at most {:.0f} are supported",
                                        frames, most_frames));
    time.frames = good_even_length(static_cast<std::ptrdiff_t>(frames));
    time.interval_s = period.period_s / static_cast<double>(time.frames);
}

void set_duration(const Reader& reader, double duration_s, TimeAxis& time) {
    const double frames = std::round(duration_s / time.interval_s);
    if (frames > most_frames)
        reader.error("output_interval_us",
                     fmt::format("results in {:.0f} frames; at most {:.0f} are supported", frames,
                                 most_frames));
    else if (!(std::abs(frames * time.interval_s - duration_s) <= 1e-6 * duration_s))
        reader.error(
            "duration_ms",
            fmt::format(
                "must be a whole number of output intervals, but {} ms is {:.6g} times {:.6g} us",
                in_milli(duration_s), duration_s / time.interval_s, 1e6 * time.interval_s));
    else
        time.frames = static_cast<std::ptrdiff_t>(frames);
}

} // namespace

TimeAxis read_time(Reader& reader, const Load* load) {
    if (reader.empty()) return {};
    const NoNewErrors no_new_errors(reader.diagnostics());
    TimeAxis time;
    const auto duration_s = reader.find_number("duration_ms", range_of<TimeAxis>("duration_ms"));
    const double longest_s = read_optional_number(reader, field_of<TimeAxis>("longest_period_ms"));
    read_fields(reader, time);
    const bool repeats = time.regime == Regime::periodic;
    if (!repeats && !reader.has("duration_ms")) reader.missing("duration_ms");
    reader.finish();
    if (!no_new_errors) return time;
    if (!repeats)
        set_duration(reader, *duration_s, time);
    else if (load)
        set_period(reader, *load, longest_s, time);
    return time;
}

MeasureOptions read_measure(Reader& reader, const Measured& of) {
    const TimeAxis& time = of.time;
    MeasureOptions measure;
    const auto at_s = reader.find_number("at_ms", range_of<MeasureOptions>("at_ms"));
    const auto settled_after_s =
        reader.find_number("settled_after_ms", range_of<MeasureOptions>("settled_after_ms"));
    measure.focal_radius_m = read_focal_radius_m(reader, of.load);
    read_fields(reader, measure);
    check_depths(reader, measure.depths_m, of.medium);
    measure.region_m = read_region(reader, of);
    const bool is_default = time.regime == Regime::periodic;
    if (const bool on = reader.find_flag("sensation").value_or(is_default); on != is_default)
        measure.sensation = on ? Sensation::on : Sensation::off;
    for (const Vec2& edges_Hz : reader.find_points("bands_Hz").value_or(std::vector<Vec2>{})) {
        if (!(edges_Hz.x >= 0.0 && edges_Hz.y > edges_Hz.x))
            reader.error(
                "bands_Hz",
                fmt::format(
                    "must contain bands [low, high] with 0 <= low < high, but contains [{}, {}]",
                    edges_Hz.x, edges_Hz.y));
        measure.bands.push_back({edges_Hz.x, edges_Hz.y});
    }
    reader.finish();
    if (time.frames == 0) return measure; // an error in [time], already reported

    const auto frame_s = frame_time_s(time, at_s.value_or(time.duration_s()));
    if (!frame_s) reader.error("at_ms", off_frame_message(time, *at_s));
    measure.at_s = frame_s.value_or(time.duration_s());
    if (time.regime == Regime::periodic) { // everything has settled
        measure.window = PeriodWeight::whole_periods;
        return measure;
    }
    measure.settled_after_s = settled_after_s.value_or(
        std::round(0.25 * measure.at_s / time.interval_s) * time.interval_s);
    if (!(measure.settled_after_s < measure.at_s)) {
        reader.error("settled_after_ms",
                     fmt::format("must be before measure.at_ms = {}, but is {}",
                                 in_milli(measure.at_s), in_milli(measure.settled_after_s)));
    }
    return measure;
}

namespace {

/// Centre and threshold of each third octave. Throws CsvError.
std::vector<Vec2> threshold_in(std::string_view csv) {
    constexpr double most_off = 0.03; // of nominal from exact centres, up to 1.6 %
    CsvReader rows(csv);
    if (!rows.next() ||
        rows.cells() != std::vector<std::string>{"frequency_Hz", "acceleration_m_s2"})
        throw CsvError(std::max<std::size_t>(rows.line(), 1),
                       "must be the header frequency_Hz,acceleration_m_s2");
    std::vector<Vec2> bands;
    std::optional<double> last;
    while (rows.next()) {
        const auto number = [&](std::size_t cell) {
            const auto value =
                rows.cells().size() == 2 ? finite_number_in(rows.cells()[cell]) : std::nullopt;
            if (!value || !(*value > 0.0))
                throw CsvError(rows.line(), fmt::format("must be two numbers above 0, but is "
                                                        "\"{}\"",
                                                        excerpt(rows.text())));
            return *value;
        };
        const Vec2 band{number(0), number(1)};
        const double tenth = std::round(10.0 * std::log10(band.x));
        if (std::abs(band.x / std::pow(10.0, 0.1 * tenth) - 1.0) > most_off)
            throw CsvError(rows.line(),
                           fmt::format("{:g} Hz is not the centre of a third octave, such as 100, "
                                       "125 and 160 Hz",
                                       band.x));
        if (last && tenth != *last + 1.0)
            throw CsvError(rows.line(), fmt::format("{:g} Hz does not follow {:g} Hz: third "
                                                    "octaves must ascend without gaps",
                                                    band.x, bands.back().x));
        last = tenth;
        bands.push_back(band);
    }
    if (bands.empty()) throw CsvError(rows.line(), "must be followed by at least one third octave");
    return bands;
}

std::optional<SensationOptions> read_sensation(Reader& reader, const Case& c,
                                               const TextLoader& load_text) {
    if (reader.empty()) return std::nullopt;
    SensationOptions options;
    if (const auto text = load_named(reader, "threshold", load_text)) try {
            options.threshold = threshold_in(*text);
        } catch (const CsvError& error) {
            reader.error("threshold",
                         fmt::format("cannot be used: {}: line {}: {}", reader.word("threshold"),
                                     error.line, error.what()));
        }
    if (const auto line_m = reader.find_points("line_mm")) {
        options.line_m = *line_m;
        if (line_m->size() != 2 || (*line_m)[0] == (*line_m)[1])
            reader.error("line_mm", "must be two different points [[x, y], [x, y]]");
        else if (c.domain.nx > 0 &&
                 !(c.domain.contains((*line_m)[0]) && c.domain.contains((*line_m)[1])))
            reader.error("line_mm", "must lie inside the domain");
    }
    if (!computes_sensation(c))
        for (const char* key : {"threshold", "line_mm"})
            if (reader.has(key)) reader.error(key, "applies only with measure.sensation = true");
    reader.finish();
    return options;
}

} // namespace

/// In a fixed order and without duplicates, so that equal sets of fields give equal cases.
std::vector<VolumeField> read_volume_fields(Reader& reader) {
    const auto names = reader.find_words("volume_fields");
    if (!names) return {VolumeField::u};
    const std::array all = {VolumeField::u, VolumeField::strain, VolumeField::stress};
    std::vector<std::string> known;
    std::vector<VolumeField> fields;
    for (const VolumeField field : all) {
        known.push_back(name_of(field));
        if (std::find(names->begin(), names->end(), known.back()) != names->end())
            fields.push_back(field);
    }
    for (const std::string& name : *names)
        if (std::find(known.begin(), known.end(), name) == known.end())
            reader.error("volume_fields", fmt::format("must contain only {}, but contains \"{}\"",
                                                      quoted_list(known), excerpt(name)));
    if (names->empty())
        reader.error("volume_fields",
                     fmt::format("must contain at least one of {}", quoted_list(known)));
    return fields;
}

void read_volumes(Reader& reader, const TimeAxis& time, RecordOptions& record) {
    const auto volumes_s = reader.find_numbers("volumes_ms", range_of<RecordOptions>("volumes_ms"));
    const std::vector<VolumeField> fields = read_volume_fields(reader);
    if (reader.has("volume_fields") && !reader.has("volumes_ms"))
        reader.error("volume_fields", "selects what is stored at record.volumes_ms, which is "
                                      "missing; add the times, or remove this key");
    if (!volumes_s || volumes_s->empty()) return;
    record.volume_fields = fields;
    if (time.frames == 0) return; // an error in [time], already reported
    for (const double t_s : *volumes_s) {
        const auto frame_s = frame_time_s(time, t_s);
        if (!frame_s) reader.error("volumes_ms", off_frame_message(time, t_s));
        record.volumes_s.push_back(frame_s.value_or(t_s));
    }
    std::sort(record.volumes_s.begin(), record.volumes_s.end());
    record.volumes_s.erase(std::unique(record.volumes_s.begin(), record.volumes_s.end()),
                           record.volumes_s.end());
}

RecordOptions read_record(Reader& reader, const Domain& domain, const TimeAxis& time,
                          const MeasureOptions& measure) {
    RecordOptions record;
    record.traces_m = reader.find_points("traces_mm").value_or(std::vector{Vec2{}});
    const auto snapshots_s =
        reader.find_numbers("snapshots_ms", range_of<RecordOptions>("snapshots_ms"));
    read_fields(reader, record);
    read_volumes(reader, time, record);
    reader.finish();
    for (const Vec2& point : record.traces_m)
        if (domain.nx > 0 && (std::abs(point.x) > 0.5 * domain.extent_x_m() ||
                              std::abs(point.y) > 0.5 * domain.extent_y_m()))
            reader.error("traces_mm", fmt::format("must lie inside the domain, within {} and {} mm "
                                                  "of its centre; [{}, {}] does not",
                                                  in_milli(0.5 * domain.extent_x_m()),
                                                  in_milli(0.5 * domain.extent_y_m()),
                                                  in_milli(point.x), in_milli(point.y)));
    if (time.frames == 0) return record;
    for (const double t_s : snapshots_s.value_or(std::vector{measure.at_s})) {
        const auto frame_s = frame_time_s(time, t_s);
        if (!frame_s) reader.error("snapshots_ms", off_frame_message(time, t_s));
        record.snapshots_s.push_back(frame_s.value_or(t_s));
    }
    return record;
}

std::span<const std::string_view> case_tables() {
    static constexpr std::array<std::string_view, 10> tables = {
        "medium",  "load",   "domain",    "time",       "solver",
        "measure", "record", "afferents", "vibrometer", "sensation"};
    return tables;
}

std::optional<Case> read_case(const NodePtr& job, OtherKinds other_kinds, const FileLoaders& files,
                              DiagnosticList& diagnostics) {
    const NoNewErrors no_new_errors(diagnostics);
    Reader root(with_medium_preset(job), "", diagnostics);
    for (const std::string_view needed : {"medium", "load", "domain", "time"})
        if (!root.has(needed)) diagnostics.error(job->at, fmt::format("[{}] is missing", needed));
    Case c;
    Reader medium = root.optional_table("medium"), load = root.optional_table("load"),
           domain = root.optional_table("domain"), time = root.optional_table("time"),
           solver = root.optional_table("solver"), measure = root.optional_table("measure"),
           record = root.optional_table("record"), afferents = root.optional_table("afferents"),
           vibrometer = root.optional_table("vibrometer"),
           sensation = root.optional_table("sensation");
    c.scene.medium = read_medium(medium, files.load_map);
    c.scene.load = read_load(load, c.scene.medium, other_kinds, files);
    c.domain = read_domain(domain);
    c.time = read_time(time, no_new_errors ? &c.scene.load : nullptr);
    c.solver = read_solver(solver, c.time);
    c.afferents = read_afferents(afferents, c.domain, &c.scene.load, files.load_text);
    c.measure =
        read_measure(measure, {c.time, c.domain, c.scene.load, c.scene.medium, c.afferents});
    c.record = read_record(record, c.domain, c.time, c.measure);
    check_receptor_depths(afferents, c);
    c.vibrometer = read_vibrometer(vibrometer, c, files.load_text);
    c.sensation = read_sensation(sensation, c, files.load_text);
    return no_new_errors ? std::optional(std::move(c)) : std::nullopt;
}

} // namespace shearwake::config
