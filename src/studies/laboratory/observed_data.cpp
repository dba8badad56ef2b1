// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/observed_data.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "engines/registry/make_engine.hpp"
#include "parallel/agree.hpp"
#include "pipeline/observers/recording.hpp"
#include "pipeline/vibrometer.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>

namespace shearwake::laboratory {
namespace {

using Json = nlohmann::ordered_json;

std::filesystem::path description_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".json";
}

std::filesystem::path numbers_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".f64";
}

template <class Read>
ConvertedData read_description(const std::filesystem::path& prefix, const Read& read) {
    const std::filesystem::path file = description_file(prefix);
    try {
        const Json root = Json::parse(storage::read_file(file));
        ConvertedData data;
        data.data = root.at("data").get<std::string>();
        data.sha256 = root.at("sha256").get<std::string>();
        data.notes = root.at("notes").get<std::vector<std::string>>();
        data.rate_Hz = root.at("rate_Hz").get<double>();
        data.noise_m_s = root.at("noise_m_s").get<double>();
        read(root, data);
        return data;
    } catch (const Json::exception& error) {
        throw UsageError(fmt::format("{} is not a converted scan: {}", file.string(), error.what()),
                         ExitCode::environment);
    }
}

Vec2 vec2(const Json& pair) {
    return {pair.at(0).get<double>(), pair.at(1).get<double>()};
}

} // namespace

ConvertedData read_surface(const std::filesystem::path& prefix) {
    return read_description(prefix, [](const Json& root, ConvertedData& data) {
        data.repetitions = root.at("repetitions").get<std::size_t>();
        data.covered_from_m = vec2(root.at("covered_from_m"));
        data.covered_to_m = vec2(root.at("covered_to_m"));
    });
}

ConvertedData read_velocities(const std::filesystem::path& prefix) {
    return read_description(prefix, [](const Json& root, ConvertedData& data) {
        const auto x = root.at("x_m").get<std::vector<double>>(),
                   y = root.at("y_m").get<std::vector<double>>();
        for (std::size_t n = 0; n < x.size(); ++n)
            data.points_m.push_back({x[n], y.at(n)});
        data.samples = root.at("samples").get<std::size_t>();
        data.start_s = root.at("start_s").get<double>();
        data.delay_s = root.at("delay_s").get<double>();
        const Json& along = root.at("direction");
        data.direction = {along.at(0).get<double>(), along.at(1).get<double>(),
                          along.at(2).get<double>()};
        data.is_line = root.at("is_line").get<bool>();
    });
}

void read_numbers(const std::filesystem::path& prefix, std::size_t first,
                  std::span<double> values) {
    const std::filesystem::path path = numbers_file(prefix);
    std::ifstream file(path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(first * sizeof(double)));
    file.read(reinterpret_cast<char*>(values.data()),
              static_cast<std::streamsize>(values.size_bytes()));
    if (!file)
        throw UsageError(fmt::format("{} is shorter than its description states", path.string()),
                         ExitCode::environment);
}

void remove_converted(const std::filesystem::path& prefix) {
    std::error_code ignored;
    std::filesystem::remove(description_file(prefix), ignored);
    std::filesystem::remove(numbers_file(prefix), ignored);
}

nlohmann::ordered_json scan_request(const ScanArguments& arguments, const Case& c) {
    nlohmann::ordered_json request = {{"least_quality", arguments.least_quality},
                                      {"outwards", arguments.outwards},
                                      {"periodic", c.time.regime == Regime::periodic},
                                      {"period_s", c.time.duration_s()}};
    if (!c.vibrometer) return request;
    const VibrometerOptions& o = *c.vibrometer;
    const Vec3 along = o.line_of_sight();
    request["vibrometer"] = {{"trigger_delay_s", o.trigger_delay_s},
                             {"offset_m", {o.offset_x_m, o.offset_y_m}},
                             {"direction", {along.x, along.y, along.z}}};
    return request;
}

void warn_of_overrides(const ScanArguments& arguments, bool is_fit) {
    const std::vector<std::string_view> in_both = {"trigger_delay_ms", "offset_x_mm", "offset_y_mm",
                                                   "tilt_deg", "azimuth_deg"},
                                        in_fit = {"spot_um", "high_pass_Hz", "low_pass_Hz"};
    for (const std::string& text : arguments.overrides) {
        const std::string key = text.substr(0, text.find('='));
        const auto is_in = [&](const std::vector<std::string_view>& names) {
            return std::ranges::any_of(names, [&](auto name) { return key.ends_with(name); });
        };
        const bool has_effect = key.starts_with("vibrometer.")
                                    ? is_in(in_both) || (is_fit && is_in(in_fit))
                                    : is_fit || !key.starts_with("solver.");
        if (!has_effect)
            fmt::print(stderr,
                       "-S {}: warning: the scan contains the recorded motion, so this "
                       "override has no effect\n",
                       printable(key));
    }
}

void convert_scan(const std::filesystem::path& data, const nlohmann::ordered_json& request,
                  const std::filesystem::path& prefix) {
    const std::filesystem::path file = prefix.string() + "-request.json";
    storage::write_file(file, request.dump());
    const int status =
        run_python_module("shearwake.laboratory.measure_scan",
                          {data.string(), file.string(), prefix.string()}, scan_packages);
    std::error_code none;
    std::filesystem::remove(file, none);
    if (status == static_cast<int>(ExitCode::usage)) throw UsageError("the scan cannot be used");
    if (status != 0)
        throw UsageError(fmt::format("the conversion of the scan failed (exit {})", status),
                         ExitCode::environment);
}

namespace {

/// Memory of the motions that are kept, and their largest number: those of a derivative.
constexpr double most_cached_B = 2.5e8, most_cached = 16.0;
/// The case is continued by this fraction of its frames, so that a larger trigger delay does not
/// move the last samples out of it.
constexpr std::ptrdiff_t margin_share = 8, least_margin = 4;

/// The case whose displacements are those of `c` for a load of 1 Pa.
Case with_unit_load(Case c) {
    c.scene.load.peak_Pa = 1.0;
    VibrometerOptions& scan = *c.vibrometer;
    scan.rate_Hz = scan.high_pass_Hz = scan.low_pass_Hz = scan.trigger_delay_s = 0.0;
    return c;
}

} // namespace

Case observed_case(Case c, const ConvertedData& data) {
    if (!c.vibrometer) {
        c.vibrometer.emplace();
        const Vec3 along = data.direction;
        c.vibrometer->tilt_rad = std::atan2(std::hypot(along.x, along.y), along.z);
        c.vibrometer->azimuth_rad = std::atan2(along.y, along.x);
        c.vibrometer->trigger_delay_s = data.delay_s;
    }
    VibrometerOptions& scan = *c.vibrometer;
    scan.points_m = data.points_m;
    for (const Vec2 nominal : data.points_m)
        if (const Vec2 point = nominal + Vec2{scan.offset_x_m, scan.offset_y_m};
            !c.domain.contains(point))
            throw UsageError(fmt::format(
                "the scan has a point at [{:.6g}, {:.6g}] mm outside of the domain of the job: "
                "enlarge domain.extent_mm, or correct the positions",
                1e3 * point.x, 1e3 * point.y));
    scan.rate_Hz = data.rate_Hz;
    scan.trigger_delay_s += data.start_s;
    scan.noise_m_s_rtHz = scan.missing_share = 0.0;
    c.record = {};
    c.afferents.reset();
    return c;
}

std::size_t covered_samples(const Case& observed, const ConvertedData& data) {
    const double duration_s = observed.time.duration_s();
    if (observed.time.regime == Regime::periodic) {
        const double samples = duration_s * data.rate_Hz;
        if (samples < 2.0 || std::abs(samples - std::round(samples)) > 1e-6 * samples)
            throw UsageError(fmt::format("the period of the load, {:.6g} ms, is not a whole number "
                                         "of samples at {:.6g} Hz: choose another sampling rate or "
                                         "modulation frequency",
                                         1e3 * duration_s, data.rate_Hz));
        return data.samples;
    }
    const double samples =
        std::floor((duration_s - observed.vibrometer->trigger_delay_s) * data.rate_Hz + 1e-9) + 1.0;
    return std::min(data.samples, static_cast<std::size_t>(std::max(samples, 0.0)));
}

ObservedModel::ObservedModel(const ConvertedData& data, std::size_t samples, const Comm& team)
    : data_(data), samples_(samples), team_(team) {}

std::vector<double> ObservedModel::velocities_m_s(const Case& given) {
    std::vector<double> rows;
    const Case c = continued(observed_case(given, data_));
    fail_together(team_, [&] {
        if (!engine_) engine_ = engines::make_engine(c.solver);
        std::vector<double> displacements_m = motion_m(with_unit_load(c));
        if (!team_.is_root()) return;
        for (double& value : displacements_m)
            value *= c.scene.load.peak_Pa;
        const pipeline::Scan scan = pipeline::scan(c, displacements_m);
        const std::size_t count = scan.time_s.size(); // one period, or at least all samples
        for (std::size_t point = 0; point < data_.points_m.size(); ++point)
            for (std::size_t n = 0; n < samples_; ++n)
                rows.push_back(scan.velocity_m_s[point * count + n % count]);
    });
    return rows;
}

Case ObservedModel::continued(Case c) {
    if (c.time.regime == Regime::periodic) return c;
    const double end_s =
        c.vibrometer->trigger_delay_s + static_cast<double>(samples_ - 1) / data_.rate_Hz;
    if (end_s > static_cast<double>(frames_) * c.time.interval_s)
        frames_ = std::max(c.time.frames,
                           static_cast<std::ptrdiff_t>(std::ceil(end_s / c.time.interval_s)) +
                               std::max(least_margin, c.time.frames / margin_share));
    c.time.frames = std::max(c.time.frames, frames_);
    return c;
}

const std::vector<double>& ObservedModel::motion_m(const Case& c) {
    const auto known = std::find_if(cached_.begin(), cached_.end(),
                                    [&](const Motion& motion) { return motion.of == c; });
    if (known != cached_.end()) {
        std::rotate(cached_.begin(), known, known + 1);
        return cached_.front().displacements_m;
    }
    pipeline::ScanSeries series(c, team_);
    engine_->run(c, team_, series, nullptr);
    series.finish();
    cached_.insert(cached_.begin(), {c, series.displacements_m()});
    const double motion_B = sizeof(double) * static_cast<double>(series.displacements_m().size());
    while (static_cast<double>(cached_.size()) >
           std::clamp(most_cached_B / motion_B, 1.0, most_cached))
        cached_.pop_back();
    return cached_.front().displacements_m;
}

} // namespace shearwake::laboratory
