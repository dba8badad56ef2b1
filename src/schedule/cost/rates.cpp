// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/rates.hpp"

#include "base/cache.hpp"
#include "pipeline/provenance.hpp"
#include "simd/instruction_set.hpp"

#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace shearwake::cost {
namespace {

using Json = nlohmann::ordered_json;

std::optional<std::filesystem::path> rates_file() {
    return cache_file(
        fmt::format("rates-{}-{}.json", processor_key(), simd::name_of(simd::instruction_set())));
}

/// The rates by engine; none if the file is absent, damaged or of another version of the program,
/// whose units of work may differ.
Json read_rates() {
    const auto file = rates_file();
    const Json json = Json::parse(file ? cached_text(*file) : "", nullptr, false);
    if (!json.is_object() || json.value("program", Json()) != pipeline::version_text())
        return Json::object();
    return json.value("rates", Json::object());
}

/// Nothing for values that an edited file could contain and that would make estimates meaningless.
std::optional<double> rate_in(const Json& rates, const std::string& engine) {
    if (!rates.is_object() || !rates.contains(engine) || !rates[engine].is_number()) return {};
    const double rate_s = rates[engine];
    return std::isfinite(rate_s) && rate_s > 0.0 ? std::optional(rate_s) : std::nullopt;
}

} // namespace

std::optional<double> recorded_rate_s(const std::string& engine) {
    return rate_in(read_rates(), engine);
}

void record_rate_s(const std::string& engine, double rate_s) {
    const auto file = rates_file();
    if (!file) return;
    Json rates = read_rates(); // which other processes may have extended
    if (!rates.is_object()) rates = Json::object();
    rates[engine] = std::sqrt(rate_s * rate_in(rates, engine).value_or(rate_s));
    replace_cached(*file,
                   Json{{"program", pipeline::version_text()}, {"rates", rates}}.dump(1) + "\n");
}

} // namespace shearwake::cost
