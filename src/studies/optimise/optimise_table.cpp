// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/optimise_study.hpp"

#include "base/units.hpp"
#include "parallel/agree.hpp"
#include "storage/files.hpp"
#include "studies/optimise/search/search.hpp"
#include "studies/tables.hpp"

#include <algorithm>

namespace shearwake::optimise {
namespace {

Reading reading(const Readings& all, const Case& physics) {
    const auto found = all.find(case_id(physics));
    return found == all.end() ? Reading{not_a_number, not_a_number} : found->second;
}

/// A row of the table without the settings of the case: column and value.
using Row = std::vector<std::pair<std::string, reduce::Cell>>;

void add_motion(Row& row, const MovedCase& moved) {
    const MotionChange& change = moved.change;
    const bool swings = change.periods > 0;
    for (const Mover& mover : moved.physics.scene.load.modulation.trajectory.parts) {
        const auto* travel = std::get_if<Travel>(&mover);
        if (!travel) continue;
        constexpr double none = not_a_number;
        const auto [mean_m_s, deviation_m_s, frequency_Hz, phase_rad] =
            std::visit(overloaded{[](const ConstantSpeed& m) {
                                      return OscillatingSpeed{m.speed_m_s, none, none, none};
                                  },
                                  [](const OscillatingSpeed& m) { return m; },
                                  [](const Rests&) {
                                      return OscillatingSpeed{none, none, none, none};
                                  }},
                       travel->motion);
        row.insert(row.end(), {{"optimum_size_1", change.size},
                               {"optimum_speed_m_s", mean_m_s},
                               {"optimum_sm_frequency_Hz", swings ? frequency_Hz : none},
                               {"optimum_sm_deviation_m_s", swings ? deviation_m_s : none},
                               {"optimum_sm_phase_deg", swings ? to_degrees(phase_rad) : none}});
        return;
    }
}

/// NaN without a complete case.
double uniformity_in(const schedule::OutputFolder& folder, const Case& physics) {
    const std::filesystem::path file = folder.case_file(case_id(physics));
    return std::filesystem::exists(file) ? uniformity_of(physics, file) : not_a_number;
}

Row row_of(const Study& study, const Optima& results, std::size_t i, std::size_t s,
           const Readings& basis, const Readings& computed) {
    const OptimiseOptions& options = study.options;
    const OptimisedCase& c = results.cases[i];
    const Optimum& of = results.optima[i][s];
    const ResultCases cases = results.results(i, s, options);
    const Reading unmodulated = reading(computed, cases.unmodulated);
    const Reading found = reading(computed, cases.found);
    bool is_valid = unmodulated.is_valid && found.is_valid;
    Row row = {{"strength_at_least_1", of.strength},
               {"eta_optimum_1", of.found.eta},
               {"strength_optimum_1", of.found.strength},
               {"eta_ceiling_1", of.ceiling.eta},
               {"ceiling_over_optimum_1", of.ceiling.eta / of.found.eta},
               {"eta_computed_1", found.eta},
               {"eta_unmodulated_1", of.eta_unmodulated},
               {"eta_am_1", of.am.envelope.eta},
               {"strength_am_1", of.am.envelope.strength},
               {"am_frequency_Hz", of.am.frequency_Hz},
               {"am_depth_1", of.am.depth},
               {"am_phase_deg", to_degrees(of.am.phase_rad)}};
    const BestSm& sm = results.sm[i][s];
    const SmCase* best = sm ? &c.sm[*sm] : nullptr;
    const Reading of_sm =
        best ? reading(basis, best->physics) : Reading{not_a_number, not_a_number};
    row.insert(row.end(),
               {{"eta_sm_1", of_sm.eta},
                {"strength_sm_1", of_sm.focal_rms_um / reading(basis, c.plain).focal_rms_um},
                {"sm_frequency_Hz", best ? best->frequency_Hz : not_a_number},
                {"sm_deviation_m_s", best ? best->deviation_m_s : not_a_number},
                {"sm_phase_deg", best ? to_degrees(best->phase_rad) : not_a_number}});
    const auto uniform = [&](const Case& physics) { return uniformity_in(study.folder, physics); };
    row.insert(row.end(), {{"uniformity_optimum_1", uniform(cases.found)},
                           {"uniformity_unmodulated_1", uniform(cases.unmodulated)},
                           {"uniformity_am_1", uniform(cases.am)},
                           {"uniformity_sm_1", cases.sm ? uniform(*cases.sm) : not_a_number}});
    if (options.over.size() > 1) add_motion(row, results.moved[i][s]);
    if (cases.exported) {
        const Reading exported = reading(computed, *cases.exported);
        is_valid = is_valid && exported.is_valid;
        row.insert(row.end(),
                   {{"eta_exported_1", exported.eta},
                    {"strength_exported_1", exported.focal_rms_um / unmodulated.focal_rms_um},
                    {"exported_loss_1", 1.0 - exported.eta / of.found.eta},
                    {"uniformity_exported_1", uniform(*cases.exported)}});
    }
    row.emplace_back("valid", is_valid && of_sm.is_valid ? "yes" : "no");
    return row;
}

/// A row with the case that it is about.
struct CaseRow {
    const OptimisedCase& of;
    Row cells;
};

/// Writes a table as CSV and Markdown; returns the Markdown.
std::string write_table(const std::filesystem::path& stem, const std::vector<CaseRow>& rows) {
    reduce::Table table;
    table.columns.emplace_back("case");
    for (const Setting& setting : rows.front().of.base.settings)
        table.columns.push_back(setting.key);
    for (const auto& cell : rows.front().cells)
        table.columns.push_back(cell.first);
    for (const CaseRow& row : rows) {
        std::vector<reduce::Cell> cells = {row.of.base.id};
        for (const Setting& setting : row.of.base.settings)
            std::visit([&](const auto& value) { cells.emplace_back(value); }, setting.value);
        for (const auto& cell : row.cells)
            cells.push_back(cell.second);
        table.rows.push_back(std::move(cells));
    }
    storage::write_file(stem.string() + ".csv", reduce::csv(table));
    const std::string text = reduce::markdown(table, table.columns);
    storage::write_file(stem.string() + ".md", text);
    return text;
}

BestSm best_sm(const Study& study, const OptimisedCase& c, double strength, const Readings& basis) {
    const double uniformity = study.options.uniformity;
    BestSm chosen;
    double eta = 0.0;
    const double unmodulated = reading(basis, c.plain).focal_rms_um;
    for (std::size_t n = 0; n < c.sm.size(); ++n) {
        const Reading sm = reading(basis, c.sm[n].physics);
        if (!(sm.eta > eta) || !(sm.focal_rms_um >= strength * unmodulated)) continue;
        if (uniformity > 0.0 && !(uniformity_in(study.basis(), c.sm[n].physics) >= uniformity))
            continue;
        chosen = n;
        eta = sm.eta;
    }
    return chosen;
}

/// The jobs of an optimum and of its exported waveform, and the waveform itself.
void write_waveforms(const Study& study, const Optima& results, std::size_t i, std::size_t s) {
    const OptimisedCase& c = results.cases[i];
    const MovedCase& moved = results.moved[i][s];
    const Optimum& of = results.optima[i][s];
    const std::string stem = study.files.stem(c, of.strength).string();
    const SampledGain found{.values = {of.found.values.begin(), of.found.values.end()},
                            .interval_s = moved.knots.interval_s,
                            .repeat = moved.knots.repeat};
    storage::write_file(stem + ".job.toml", job_of_optimum(study, c, moved, found));
    const auto waveform = exported(moved.knots, of, study.options);
    if (!waveform) return;
    storage::write_file(stem + ".csv",
                        csv_text(*waveform, moved.physics.scene.load.modulation.trajectory));
    storage::write_file(stem + ".toml", toml_text(*waveform));
    storage::write_file(stem + ".exported.job.toml",
                        job_of_optimum(study, c, moved, gain_of(*waveform)));
}

} // namespace

Readings readings_of(const schedule::OutputFolder& folder, const std::string& maximised) {
    const reduce::Table table = studies::table_of(folder);
    const std::size_t eta = table.find(maximised).value(), rms = table.find("focal_rms_um").value(),
                      valid = table.find("valid").value();
    Readings readings;
    for (const auto& row : table.rows)
        readings[std::get<std::string>(row[0])] = {std::get<double>(row.at(eta)),
                                                   std::get<double>(row.at(rms)),
                                                   row.at(valid) != reduce::Cell("no")};
    return readings;
}

std::vector<std::vector<BestSm>> agreed_sm(const Study& study, const Comm& world) {
    const std::vector<double>& strengths = study.options.strengths;
    std::vector<int> chosen; // -1: none
    on_root(world, [&] {
        const Readings basis = readings_of(study.basis(), study.options.maximise);
        for (const OptimisedCase& c : study.cases)
            for (const double strength : strengths) {
                const BestSm sm = best_sm(study, c, strength, basis);
                chosen.push_back(sm ? static_cast<int>(*sm) : -1);
            }
    });
    world.broadcast(chosen);
    std::vector<std::vector<BestSm>> best(study.cases.size());
    for (std::size_t n = 0; n < chosen.size(); ++n)
        best[n / strengths.size()].push_back(
            chosen[n] < 0 ? std::nullopt : BestSm(static_cast<std::size_t>(chosen[n])));
    return best;
}

std::string write_optima(const Study& study, const Optima& results, const Readings& basis) {
    const Readings computed = readings_of(study.folder, study.options.maximise);
    std::vector<CaseRow> rows;
    for (std::size_t i = 0; i < results.cases.size(); ++i)
        for (std::size_t s = 0; s < results.optima[i].size(); ++s) {
            rows.push_back({results.cases[i], row_of(study, results, i, s, basis, computed)});
            write_waveforms(study, results, i, s);
        }
    return write_table(study.files.root / "table", rows);
}

namespace {

/// Whether two cases differ in the tissue alone.
bool differ_in_tissue(const Case& a, const Case& b) {
    Case same = a;
    same.scene.medium = b.scene.medium;
    return !(a == b) && same == b;
}

/// The rows of the optimum of a case in the tissues of the other cases of the job, whose forms are
/// known.
void add_other_tissues(std::vector<CaseRow>& rows, const Study& study, const Optima& results,
                       std::size_t i, std::size_t s) {
    const Optimum& of = results.optima[i][s];
    if (of.change != MotionChange{}) return;
    for (std::size_t j = 0; j < results.cases.size(); ++j) {
        const OptimisedCase& other = results.cases[j];
        if (!differ_in_tissue(results.cases[i].base.physics, other.base.physics)) continue;
        const Forms forms = known_forms(study, moved_case(study.cases, j, {}).value());
        const Envelope there = measured(forms, of.found.values);
        const double plain = unmodulated(forms).eta;
        rows.push_back({results.cases[i],
                        {{"strength_at_least_1", of.strength},
                         {"difference", "tissue of " + other.base.id},
                         {"eta_found_1", there.eta},
                         {"eta_unmodulated_1", plain},
                         {"found_over_unmodulated_1", there.eta / plain},
                         {"strength_1", there.strength}}});
    }
}

} // namespace

std::string write_robustness(const Study& study, const Optima& results,
                             const std::vector<RobustCase>& cases) {
    const Readings computed =
        readings_of(schedule::OutputFolder{study.folder.robustness()}, study.options.maximise);
    std::vector<CaseRow> rows;
    for (const RobustCase& c : cases) {
        const Reading found = reading(computed, c.found),
                      unmodulated = reading(computed, c.unmodulated);
        rows.push_back({results.cases[c.of],
                        {{"strength_at_least_1", results.optima[c.of][c.strength].strength},
                         {"difference", c.difference},
                         {"eta_found_1", found.eta},
                         {"eta_unmodulated_1", unmodulated.eta},
                         {"found_over_unmodulated_1", found.eta / unmodulated.eta},
                         {"strength_1", found.focal_rms_um / unmodulated.focal_rms_um}}});
    }
    for (std::size_t i = 0; i < results.cases.size(); ++i)
        for (std::size_t s = 0; s < results.optima[i].size(); ++s)
            if (study.options.is_robust_strength(results.optima[i][s].strength))
                add_other_tissues(rows, study, results, i, s);
    return write_table(study.files.root / "robustness", rows);
}

} // namespace shearwake::optimise
