// SPDX-License-Identifier: BSD-3-Clause
#include "app/commands/commands.hpp"

#include "base/text.hpp"
#include "config/job.hpp"
#include "parallel/agree.hpp"
#include "pipeline/afferent_result.hpp"
#include "pipeline/case_content.hpp"
#include "pipeline/provenance.hpp"
#include "problem/case/text_walk.hpp"
#include "schedule/run/run.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"
#include "storage/input/input_files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace shearwake::app {
namespace {

struct RespondArguments {
    std::filesystem::path motion;  // CSV or HDF5; empty: a prescribed carrier
    std::string group;             // of the HDF5 file; empty: /traces or the root group
    std::filesystem::path options; // TOML with [afferents]; empty: defaults
    std::vector<std::string> overrides;
    std::filesystem::path out;   // HDF5; empty: only the summary is printed
    double duration_ms = 1000.0; // of a prescribed carrier
    double modulation_Hz = 0.0;  // reference frequency of phase locking for a motion; 0: none

    bool overrides_radius() const {
        return std::ranges::any_of(overrides, [](const std::string& text) {
            return text.starts_with("afferents.pin_radius");
        });
    }
};

AfferentOptions options_of(const RespondArguments& arguments) {
    const auto overrides = schedule::parse_overrides(arguments.overrides);
    const bool has_file = !arguments.options.empty();
    const std::filesystem::path folder = has_file ? arguments.options.parent_path() : ".";
    return read_afferent_options(
        has_file ? storage::read_file(arguments.options, storage::largest_user_text_B) : "",
        has_file ? arguments.options.string() : "options", overrides, [&](const std::string& file) {
            return storage::read_file(folder / file, storage::largest_user_text_B);
        });
}

struct GivenMotion {
    pipeline::ReceptorMotion motion;
    std::string text; // what was read, with its units; empty: a prescribed carrier
    std::vector<std::string> doubts;
};

/// No skin is indented by more.
constexpr double deepest_m = 0.05;

void check_depth(const RespondArguments& arguments, const PointMotion& motion) {
    for (const std::vector<double>& line : motion.u_m)
        for (const double u_m : line)
            if (std::isfinite(u_m) && std::abs(u_m) > deepest_m)
                throw UsageError(fmt::format(
                    "{}: a displacement is {:.6g} mm, but at most {:.6g} mm are plausible: check "
                    "the unit of the displacements",
                    arguments.motion.string(), 1e3 * u_m, 1e3 * deepest_m));
}

/// Warnings of a motion that is probably in other units. Stimulators of studies of the sense of
/// touch indent the skin by 10 nm to some mm, and a nerve fibre fires at most about once per
/// millisecond.
std::vector<std::string> doubts_of(const std::vector<std::vector<double>>& u_m, double rate_Hz) {
    constexpr double large_m = 5e-3, small_m = 1e-9, short_s = 1e-3;
    double largest_m = 0.0;
    for (const std::vector<double>& line : u_m)
        for (const double value_m : line)
            largest_m = std::max(largest_m, std::abs(value_m));
    std::vector<std::string> doubts;
    if (largest_m > large_m || (largest_m > 0.0 && largest_m < small_m))
        doubts.push_back(fmt::format("the largest displacement is {:.4g} um; studies of the sense "
                                     "of touch indent the skin by 0.01 to some 1000 um: check the "
                                     "unit of the displacements",
                                     1e6 * largest_m));
    if (const auto samples = static_cast<double>(u_m.empty() ? 0 : u_m.front().size());
        samples < short_s * rate_Hz)
        doubts.push_back(fmt::format("the motion lasts {:.4g} ms, less than the time between two "
                                     "spikes of a nerve fibre: check the unit of the times",
                                     1e3 * samples / rate_Hz));
    return doubts;
}

/// "500 samples at 5000 Hz for each of 2 pins, 0 to 60 um".
std::string range_text(const char* noun, const std::vector<std::vector<double>>& lines,
                       double rate_Hz, double scale, const char* unit) {
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const std::vector<double>& line : lines)
        for (const double value : line) {
            low = std::min(low, value);
            high = std::max(high, value);
        }
    return fmt::format("{} samples at {:.6g} Hz for each of {} {}, {:.4g} to {:.4g} {}",
                       lines.empty() ? 0 : lines.front().size(), rate_Hz, lines.size(), noun,
                       scale * low, scale * high, unit);
}

/// Reads the motion or the stress from the file; positions and radius of the pins are copied from
/// the file to the options. For a prescribed carrier the motion is zero and has its duration.
GivenMotion motion_of(const RespondArguments& arguments, AfferentOptions& options) {
    std::string text;
    std::vector<std::string> doubts;
    pipeline::ReceptorMotion motion{.modulation_Hz = arguments.modulation_Hz, .name = "respond"};
    const auto* carrier = std::get_if<CarrierInput>(&options.input);
    if (carrier && !arguments.motion.empty())
        throw UsageError("a prescribed carrier and a MOTION cannot be combined: omit MOTION, or "
                         "remove afferents.carrier");
    if (!carrier && arguments.motion.empty())
        throw UsageError("respond needs a MOTION (CSV or HDF5), or a carrier: -S "
                         "afferents.input=carrier -S 'afferents.carrier={amplitude_um = 50}'");
    if (carrier) {
        const auto samples =
            static_cast<std::size_t>(std::llround(1e-3 * arguments.duration_ms * 5000.0));
        motion.pins = {.rate_Hz = 5000.0, .u_m = {std::vector<double>(samples)}};
        motion.modulation_Hz = carrier->am_frequency_Hz;
    } else if (uses_stress(options.input)) {
        PointStress stress = storage::read_stress(arguments.motion, arguments.group);
        motion.pins.rate_Hz = stress.rate_Hz;
        text = "stress: " +
               range_text("receptor(s)", stress.compression_Pa, stress.rate_Hz, 1.0, "Pa");
        motion.compression_Pa = std::move(stress.compression_Pa);
    } else {
        motion.pins = storage::read_motion(arguments.motion, arguments.group);
        check_depth(arguments, motion.pins);
        doubts = doubts_of(motion.pins.u_m, motion.pins.rate_Hz);
        if (!motion.pins.at_m.empty()) options.pins_m = motion.pins.at_m;
        if (motion.pins.radius_m && !arguments.overrides_radius())
            options.pin_radius_m = *motion.pins.radius_m;
        if (options.pins_m.size() != motion.pins.u_m.size())
            throw UsageError(fmt::format("[afferents] defines {} pins, but {} has {} traces: the "
                                         "numbers must be equal",
                                         options.pins_m.size(), arguments.motion.string(),
                                         motion.pins.u_m.size()));
        text = "motion: " + range_text("pin(s)", motion.pins.u_m, motion.pins.rate_Hz, 1e6, "um");
    }
    const auto& lines = motion.compression_Pa.empty() ? motion.pins.u_m : motion.compression_Pa;
    const std::size_t samples = lines.empty() ? 0 : lines.front().size();
    // Rest may have been prepended.
    if (!carrier && !storage::is_csv(arguments.motion) && lines.size() > 1 &&
        (samples == lines.size() || samples == lines.size() + 1))
        text += "; the first index of the array is taken as that of the point, the second as that "
                "of the time";
    motion.path_m = options.pins_m;
    return {std::move(motion), std::move(text), std::move(doubts)};
}

/// Checks the output path before anything is computed.
void check_out(const std::filesystem::path& out) {
    const std::filesystem::path folder = out.has_parent_path() ? out.parent_path() : ".";
    if (!out.empty() && !std::filesystem::is_directory(folder))
        throw UsageError(
            fmt::format("--out {}: the folder {} does not exist", out.string(), folder.string()),
            ExitCode::environment);
}

void write(const std::filesystem::path& out, const std::vector<VariableGroup>& groups,
           const std::vector<Attribute>& attributes) {
    try {
        storage::write_record(out, groups, attributes);
    } catch (const UsageError&) {
        throw;
    } catch (const Error& error) {
        throw UsageError(error.what(), ExitCode::environment);
    }
}

std::string canonical(const AfferentOptions& options) {
    TextWalk text;
    text.section("afferents");
    walk_fields(text, options);
    return text.take();
}

void print(const pipeline::AfferentResult& result, const std::filesystem::path& out) {
    for (const std::string& note : result.notes)
        fmt::print(stderr, "{}\n", coloured("warning: " + note, stderr));
    fmt::print("{:>5} {:>10} {:>7} {:>9} {:>9} {:>10} {:>8} {:>14}\n", "class", "afferents",
               "active", "spikes", "rate_Hz", "spread_mm", "locking", "first_spike_ms");
    for (const neural::ClassResponse& r : result.classes) {
        const auto shown = [](double value, const char* form) {
            return std::isnan(value) ? std::string("-") : fmt::format(fmt::runtime(form), value);
        };
        fmt::print("{:>5} {:>10} {:>7} {:>9} {:>9} {:>10} {:>8} {:>14}\n", name_of(r.kind),
                   r.afferents, r.active, r.spikes, shown(r.mean_rate_Hz, "{:.2f}"),
                   shown(r.spread_mm, "{:.2f}"), shown(r.locking, "{:.3f}"),
                   shown(r.first_spike_ms, "{:.1f}"));
    }
    if (!out.empty()) fmt::print("spikes: {}, group afferents\n", out.string());
}

ExitCode respond_command(const RespondArguments& arguments, const Comm& world) {
    AfferentOptions options;
    GivenMotion given;
    together(world, [&] { // every rank reads the same small files
        check_out(arguments.out);
        options = options_of(arguments);
        given = motion_of(arguments, options);
    });
    pipeline::ReceptorMotion& motion = given.motion;
    motion.name = canonical(options); // seeds the noise
    pipeline::AfferentResult result;
    try {
        result = pipeline::simulate_afferents(motion, options, neural::make_scene(options), world);
    } catch (const CaseFailure& failure) {
        throw UsageError(failure.what());
    }
    result.notes.insert(result.notes.begin(), given.doubts.begin(), given.doubts.end());
    on_root(world, [&] {
        std::vector<VariableGroup> groups = {{"", {}}};
        pipeline::add_columns(result.columns, groups.front());
        for (const VariableGroup& group : result.groups)
            groups.push_back(group);
        std::vector<Attribute> attributes = {
            {"title", std::string("responses of afferents")},
            {"motion", arguments.motion.string()},
            {"afferents", motion.name},
            {"notes", fmt::format("{}", fmt::join(result.notes, "\n"))}};
        for (Attribute& attribute : pipeline::program_attributes())
            attributes.push_back(std::move(attribute));
        if (!arguments.out.empty()) write(arguments.out, groups, attributes);
        if (!given.text.empty()) fmt::print("{}\n", given.text);
        print(result, arguments.out);
    });
    return ExitCode::done;
}

} // namespace

void add_respond(CLI::App& app, Action& action) {
    auto [command, arguments] = add_command<RespondArguments>(
        app, action, "respond",
        "compute the spikes of nerve fibres for a given motion of the skin, without a simulation",
        respond_command);
    command.add_option(
        "MOTION", arguments.motion,
        "CSV or HDF5 file with the displacement at points (with afferents.input=stress: the stress "
        "at the receptors). If it is omitted, the carrier of afferents.carrier is used");
    add_value(command, "--group", arguments.group, "NAME",
              "group of the HDF5 file (default: traces, or the root group)");
    add_value(command, "--options", arguments.options, "FILE",
              "file with a table [afferents], for example a job");
    add_overrides(command, arguments.overrides, "override a key: -S afferents.where=hand");
    add_value(command, "--out", arguments.out, "FILE", "write the spikes to this file (HDF5)");
    command
        .add_option("--duration-ms", arguments.duration_ms,
                    "duration of a prescribed carrier (default 1000)")
        ->check(CLI::Range(1.0, 1e5));
    command
        .add_option("--modulation-Hz", arguments.modulation_Hz,
                    "reference frequency for the phase locking of spikes")
        ->check(CLI::Range(1e-3, 1e6));
}

} // namespace shearwake::app
