// SPDX-License-Identifier: BSD-3-Clause
#include "app/optimise_table.hpp"

#include "reduce/reduce.hpp"
#include "storage/files.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>

namespace shearwake::app {
namespace {

using optimise::OptimisedCase;
using optimise::Optimum;

constexpr double absent = std::numeric_limits<double>::quiet_NaN();

double degrees(double rad) {
    return 180.0 / std::numbers::pi * rad;
}

Reading reading(const std::map<std::string, Reading>& all, const Case& physics) {
    const auto found = all.find(case_id(physics));
    return found == all.end() ? Reading{absent, absent} : found->second;
}

/// A row of the table without the settings of the case: column and value.
using Row = std::vector<std::pair<std::string, double>>;

Row row_of(const OptimisedCase& c, const Optimum& of, const optimise::BestSm& sm,
           const optimise::ResultCases& cases, const std::map<std::string, Reading>& basis,
           const std::map<std::string, Reading>& computed) {
    const Reading unmodulated = reading(computed, cases.unmodulated);
    Row row = {{"strength_at_least_1", of.strength},
               {"eta_optimum_1", of.found.eta},
               {"strength_optimum_1", of.found.strength},
               {"eta_ceiling_1", of.ceiling.eta},
               {"ceiling_over_optimum_1", of.ceiling.eta / of.found.eta},
               {"eta_computed_1", reading(computed, cases.found).eta},
               {"eta_unmodulated_1", of.eta_unmodulated},
               {"eta_am_1", of.am.envelope.eta},
               {"strength_am_1", of.am.envelope.strength},
               {"am_frequency_Hz", of.am.frequency_Hz},
               {"am_depth_1", of.am.depth},
               {"am_phase_deg", degrees(of.am.phase_rad)}};
    const optimise::SmCase* best = sm ? &c.sm[*sm] : nullptr;
    const Reading of_sm = best ? reading(basis, best->physics) : Reading{absent, absent};
    row.insert(row.end(),
               {{"eta_sm_1", of_sm.eta},
                {"strength_sm_1", of_sm.focal_rms_um / reading(basis, c.plain).focal_rms_um},
                {"sm_frequency_Hz", best ? best->frequency_Hz : absent},
                {"sm_deviation_m_s", best ? best->deviation_m_s : absent},
                {"sm_phase_deg", best ? degrees(best->phase_rad) : absent}});
    if (cases.exported) {
        const Reading exported = reading(computed, *cases.exported);
        row.insert(row.end(),
                   {{"eta_exported_1", exported.eta},
                    {"strength_exported_1", exported.focal_rms_um / unmodulated.focal_rms_um}});
    }
    return row;
}

reduce::Table table_of_rows(const std::vector<std::vector<Row>>& rows, const Optima& results) {
    reduce::Table table;
    table.columns.emplace_back("case");
    for (const Setting& setting : results.cases.front().base.settings)
        table.columns.push_back(setting.key);
    for (const auto& [column, value] : rows.front().front())
        table.columns.push_back(column);
    for (std::size_t i = 0; i < rows.size(); ++i)
        for (const Row& row : rows[i]) {
            std::vector<reduce::Cell> cells = {results.cases[i].base.id};
            for (const Setting& setting : results.cases[i].base.settings)
                std::visit([&](const auto& value) { cells.emplace_back(value); }, setting.value);
            for (const auto& [column, value] : row)
                cells.emplace_back(value);
            table.rows.push_back(std::move(cells));
        }
    return table;
}

void write_waveform(const std::filesystem::path& stem, const optimise::Waveform& waveform) {
    storage::write_file(stem.string() + ".csv", optimise::csv_text(waveform));
    storage::write_file(stem.string() + ".toml", optimise::toml_text(waveform));
}

} // namespace

std::map<std::string, Reading> readings_of(const schedule::OutputFolder& folder) {
    const reduce::Table table =
        reduce::table_of({.folder = folder.root, .plan = folder.plan(), .tables = folder.tables()});
    const auto place = [&](const std::string& name) {
        return static_cast<std::size_t>(std::ranges::find(table.columns, name) -
                                        table.columns.begin());
    };
    const std::size_t eta = place("eta_period_1"), rms = place("focal_rms_um");
    std::map<std::string, Reading> readings;
    for (const auto& row : table.rows)
        readings[std::get<std::string>(row[0])] = {std::get<double>(row.at(eta)),
                                                   std::get<double>(row.at(rms))};
    return readings;
}

std::vector<std::vector<optimise::BestSm>> best_sm(const std::vector<OptimisedCase>& cases,
                                                   const std::vector<double>& strengths,
                                                   const std::map<std::string, Reading>& basis) {
    std::vector<std::vector<optimise::BestSm>> best(cases.size());
    for (std::size_t i = 0; i < cases.size(); ++i)
        for (const double strength : strengths) {
            optimise::BestSm chosen;
            double eta = 0.0;
            const double unmodulated = reading(basis, cases[i].plain).focal_rms_um;
            for (std::size_t n = 0; n < cases[i].sm.size(); ++n) {
                const Reading sm = reading(basis, cases[i].sm[n].physics);
                if (!(sm.eta > eta) || !(sm.focal_rms_um >= strength * unmodulated)) continue;
                chosen = n;
                eta = sm.eta;
            }
            best[i].push_back(chosen);
        }
    return best;
}

std::string write_optima(const schedule::OutputFolder& folder, const Optima& results,
                         const OptimiseOptions& options,
                         const std::map<std::string, Reading>& basis) {
    const std::map<std::string, Reading> computed = readings_of(folder);
    std::vector<std::vector<Row>> rows(results.cases.size());
    for (std::size_t i = 0; i < results.cases.size(); ++i)
        for (std::size_t s = 0; s < results.optima[i].size(); ++s) {
            const OptimisedCase& c = results.cases[i];
            const Optimum& of = results.optima[i][s];
            rows[i].push_back(row_of(c, of, results.sm[i][s],
                                     optimise::result_cases(c, of, results.sm[i][s], options),
                                     basis, computed));
            if (const auto waveform = optimise::exported(c, of, options))
                write_waveform(folder.optimise() /
                                   fmt::format("{}.strength-{:g}", c.base.id, of.strength),
                               *waveform);
        }
    const reduce::Table table = table_of_rows(rows, results);
    storage::write_file(folder.optimise() / "table.csv", reduce::csv(table));
    const std::string text = reduce::markdown(table, table.columns);
    storage::write_file(folder.optimise() / "table.md", text);
    return text;
}

} // namespace shearwake::app
