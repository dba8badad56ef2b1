// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/fit_output.hpp"

#include "base/error.hpp"
#include "pipeline/provenance.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <numeric>

namespace shearwake::laboratory {
namespace {

using Document = nlohmann::ordered_json;

constexpr double outlier_weight = 0.5;

long outliers(const FitResult& result) {
    return std::count_if(result.weights.begin(), result.weights.end(),
                         [](double weight) { return weight < outlier_weight; });
}

Document estimates_of(const FitOutput& output) {
    Document estimates = Document::object();
    for (std::size_t i = 0; i < output.parameters.size(); ++i) {
        const Estimate& e = output.result.estimates[i];
        estimates[output.parameters[i].key] = {
            {"value", e.value},
            {"standard_error", e.standard_error},
            {"interval_95", {e.low_95, e.high_95}},
            {"bounds", {output.parameters[i].low, output.parameters[i].high}},
            {"at_bound", e.is_at_bound}};
    }
    return estimates;
}

Document correlations_of(const FitOutput& output) {
    const std::size_t count = output.parameters.size();
    Document rows = Document::array();
    for (std::size_t i = 0; i < count; ++i) {
        Document row = Document::array();
        for (std::size_t j = 0; j < count; ++j)
            row.push_back(output.result.correlations[i * count + j]);
        rows.push_back(row);
    }
    return rows;
}

Document simpler_of(const FitOutput& output) {
    Document list = Document::array();
    for (const SimplerFit& one : output.simpler)
        list.push_back({{"key", one.key},
                        {"law", one.law},
                        {"bic_change", one.change},
                        {"suffices", one.change < 0.0}});
    return list;
}

} // namespace

void write_fit(const std::filesystem::path& folder, const std::filesystem::path& job,
               const FitOutput& output) {
    const ConvertedData& data = output.data;
    const Document root = {{"schema", 1},
                           {"job", job.string()},
                           {"data", data.data},
                           {"sha256", data.sha256},
                           {"notes", data.notes},
                           {"converged", output.result.has_converged},
                           {"solver", output.result.report},
                           {"estimates", estimates_of(output)},
                           {"correlations", correlations_of(output)},
                           {"noise_m_s", output.result.noise},
                           {"points", data.points_m.size()},
                           {"outliers", outliers(output.result)},
                           {"is_line", data.is_line},
                           {"simpler_laws", simpler_of(output)}};
    storage::write_file(folder / "fit.json", root.dump(2) + "\n");
    std::vector<double> numbers(data.points_m.size()), x, y, times;
    std::iota(numbers.begin(), numbers.end(), 0.0);
    for (const Vec2 point : data.points_m) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    for (std::size_t n = 0; n < output.samples; ++n)
        times.push_back(data.start_s + static_cast<double>(n) / data.rate_Hz);
    const VariableGroup group = {
        "",
        {{"point", {"point"}, numbers, "1", "number of the point of the scan", ""},
         {"time", {"time"}, times, "s", "time since the trigger", ""},
         {"x", {"point"}, x, "m", "position of the point along x", ""},
         {"y", {"point"}, y, "m", "position of the point along y", ""},
         {"measured",
          {"point", "time"},
          {output.observed.begin(), output.observed.end()},
          "m/s",
          "measured velocity along the line of sight",
          ""},
         {"predicted",
          {"point", "time"},
          output.result.predicted,
          "m/s",
          "velocity of the model with the estimates",
          ""},
         {"residual_rms",
          {"point"},
          output.result.residual_rms,
          "m/s",
          "root mean square of measured minus predicted velocity",
          ""},
         {"weight",
          {"point"},
          output.result.weights,
          "1",
          "weight of the point in the fit; below 0.5: an outlier",
          ""}}};
    storage::write_record(folder / "fit.h5", {group}, pipeline::program_attributes());
}

void print_fit(const FitOutput& output) {
    const FitResult& result = output.result;
    for (const std::string& note : output.data.notes)
        fmt::print("{}\n", note);
    std::size_t width = 9;
    for (const Parameter& parameter : output.parameters)
        width = std::max(width, parameter.key.size());
    fmt::print("{:<{}} {:>12} {:>12} {:>26}\n", "parameter", width, "estimate", "std. error",
               "95 % interval");
    for (std::size_t i = 0; i < output.parameters.size(); ++i) {
        const Estimate& e = result.estimates[i];
        fmt::print("{:<{}} {:>12.6g} {:>12.3g} {:>12.6g} {:>13.6g}{}\n", output.parameters[i].key,
                   width, e.value, e.standard_error, e.low_95, e.high_95,
                   e.is_at_bound ? " (at its bound)" : "");
    }
    const std::size_t count = output.parameters.size();
    for (std::size_t i = 0; i < count; ++i)
        for (std::size_t j = i + 1; j < count; ++j)
            fmt::print("correlation of {} and {}: {:.2f}\n", output.parameters[i].key,
                       output.parameters[j].key, result.correlations[i * count + j]);
    fmt::print("residual: {:.4g} um/s per sample; {} of {} points are outliers\n",
               1e6 * result.noise, outliers(result), output.data.points_m.size());
    for (const SimplerFit& one : output.simpler)
        fmt::print(
            "simpler law ({}, without {}): {} (change of the information criterion {:+.4g})\n",
            one.law, one.key, one.change < 0.0 ? "suffices" : "does not suffice", one.change);
    if (!result.has_converged)
        fmt::print(stderr, "warning: the fit has not converged: {}\n", result.report);
}

} // namespace shearwake::laboratory
