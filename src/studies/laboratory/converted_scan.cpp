// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/converted_scan.hpp"

#include "base/error.hpp"
#include "base/python_module.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::laboratory {

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

} // namespace shearwake::laboratory
