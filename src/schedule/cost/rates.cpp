// SPDX-License-Identifier: BSD-3-Clause
#include "schedule/cost/rates.hpp"

#include "base/cache.hpp"
#include "base/json.hpp"
#include "pipeline/provenance.hpp"
#include "simd/instruction_set.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::cost {
namespace {

std::optional<std::filesystem::path> rates_file() {
    return cache_file(
        fmt::format("rates-{}-{}.json", processor_key(), simd::name_of(simd::instruction_set())));
}

/// The rates by engine; none if the file is absent, damaged or of another version of the program,
/// whose units of work may differ.
Json read_rates() {
    const auto file = rates_file();
    const Json json = Json::parse_or_null(file ? cached_text(*file) : "");
    const Json *program = json.find("program"), *rates = json.find("rates");
    if (!program || *program != pipeline::version_text() || !rates) return Json::object();
    return *rates;
}

/// Nothing for values that an edited file could contain and that would make estimates meaningless.
std::optional<double> rate_in(const Json& rates, const std::string& engine) {
    const Json* found = rates.find(engine);
    if (!found || !found->is_number()) return {};
    const auto rate_s = found->get<double>();
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
