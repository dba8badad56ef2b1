// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/observed_data.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>

namespace shearwake::laboratory {
namespace {

std::filesystem::path description_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".json";
}

std::filesystem::path numbers_file(const std::filesystem::path& prefix) {
    return prefix.string() + ".f64";
}

Vec2 vec2(const Json& pair) {
    return {pair.at(0).get<double>(), pair.at(1).get<double>()};
}

} // namespace

ConvertedData read_surface(const std::filesystem::path& prefix) {
    const std::filesystem::path file = description_file(prefix);
    try {
        const Json root = Json::parse(storage::read_file(file));
        return {.data = root.at("data").get<std::string>(),
                .sha256 = root.at("sha256").get<std::string>(),
                .notes = root.at("notes").get<std::vector<std::string>>(),
                .repetitions = root.at("repetitions").get<std::size_t>(),
                .covered_from_m = vec2(root.at("covered_from_m")),
                .covered_to_m = vec2(root.at("covered_to_m"))};
    } catch (const JsonError& error) {
        throw UsageError(fmt::format("{} is not a converted scan: {}", file.string(), error.what()),
                         ExitCode::environment);
    }
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

Json scan_request(const MeasureArguments& arguments, const Case& c) {
    Json request = {{"least_quality", arguments.least_quality},
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

void warn_of_overrides(const MeasureArguments& arguments) {
    constexpr std::array used = {"trigger_delay_ms", "offset_x_mm", "offset_y_mm", "tilt_deg",
                                 "azimuth_deg"};
    for (const std::string& text : arguments.overrides) {
        const std::string key = text.substr(0, text.find('='));
        const bool has_effect =
            key.starts_with("vibrometer.")
                ? std::ranges::any_of(used, [&](const char* name) { return key.ends_with(name); })
                : !key.starts_with("solver.");
        if (!has_effect)
            fmt::print(stderr,
                       "-S {}: warning: the scan contains the recorded motion, so this "
                       "override has no effect\n",
                       printable(key));
    }
}

void convert_scan(const std::filesystem::path& data, const Json& request,
                  const std::filesystem::path& prefix) {
    const std::filesystem::path file = prefix.string() + "-request.json";
    storage::write_file(file, request.dump());
    const int status =
        run_python_module("shearwake.laboratory.measure_scan",
                          {data.string(), file.string(), prefix.string()}, scan_packages);
    std::error_code ignored;
    std::filesystem::remove(file, ignored);
    if (status == static_cast<int>(ExitCode::usage)) throw UsageError("the scan cannot be used");
    if (status != 0)
        throw UsageError(fmt::format("the conversion of the scan failed (exit {})", status),
                         ExitCode::environment);
}

} // namespace shearwake::laboratory
