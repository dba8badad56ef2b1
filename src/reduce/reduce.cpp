// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/reduce.hpp"

#include "base/error.hpp"
#include "base/json.hpp"
#include "base/labels.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "measures/measure_table.hpp"
#include "reduce/derived_tables.hpp"
#include "storage/case_file/case_index.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <map>
#include <sstream>
#include <unordered_set>

namespace shearwake::reduce {
namespace {

/// A row of the table, from the case file or from what is known about a missing one.
struct CaseRow {
    std::string status, valid;
    std::vector<std::string> remarks; // of its note
    double wall_s = not_a_number;
    const storage::CaseDigest* digest = nullptr; // owned by the index

    double value(const std::string& name) const {
        if (digest)
            for (const storage::IndexedScalar& v : digest->scalars)
                if (v.name == name) return v.value;
        return not_a_number;
    }
};

/// The places where the report shows a column.
const char* name_of(measures::Shown shown) {
    switch (shown) {
    case measures::Shown::csv:
        return "csv";
    case measures::Shown::shapes:
        return "shapes";
    case measures::Shown::page:
    case measures::Shown::headlines:
        break;
    }
    return "page";
}

Json json_of_column(const std::string& name, const std::string& error_meaning) {
    const std::string error_of = column_of_error(name);
    const measures::Measure* measure = measures::find_measure(error_of.empty() ? name : error_of);
    const std::string meaning = measure ? measures::with_details(measure->meaning, {}) : "";
    const bool is_value = measure && error_of.empty();
    return {{"name", name},
            {"unit", measure ? measure->unit : ""},
            {"meaning", error_of.empty() ? meaning : error_meaning + " of " + error_of},
            {"shown", name_of(is_value ? measure->shown : measures::Shown::csv)},
            {"over_reference_of", is_value ? measure->over_reference_of : ""},
            {"counts_samples", measures::counts_samples(name)}};
}

/// The columns of measures: all between the swept keys and the closing columns.
std::vector<std::string> measure_columns(const storage::PlanIndex& plan, const Table& table) {
    return {table.columns.begin() + static_cast<std::ptrdiff_t>(2 + plan.swept_keys.size()),
            table.columns.end() - static_cast<std::ptrdiff_t>(closing_columns)};
}

/// The table as JSON: every column with its unit and description; every case with its values (null:
/// none); and the sentences of `note`, the reasons for empty cells, and the warnings, to which the
/// cases refer by numbers from 1.
std::string json_text(const storage::PlanIndex& plan, const Table& table, storage::CaseIndex& index,
                      const std::string& meaning_of_errors) {
    Json columns = Json::array();
    const std::size_t first = 2 + plan.swept_keys.size(),
                      end = table.columns.size() - closing_columns;
    std::vector<std::string> names = measure_columns(plan, table);
    const auto place = [](const std::string& name) {
        const std::string error_of = column_of_error(name);
        const measures::Measure* measure =
            measures::find_measure(error_of.empty() ? name : error_of);
        return std::pair(measures::is_at_instant(name),
                         measure ? measure - measures::all_measures().data()
                                 : std::ssize(measures::all_measures()));
    };
    std::ranges::stable_sort(names, {}, place);
    for (const std::string& name : names)
        columns.push_back(json_of_column(name, meaning_of_errors));
    // A case is one line, and texts that cases have in common are stored once.
    Numbering reasons, warnings;
    std::string lines = fmt::format("{{\"columns\": {},\n\"cases\": [\n", columns.dump());
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto& cells = table.rows[row];
        Json values = Json::object(), notes = Json::object(), warned = Json::array();
        for (std::size_t i = first; i < end; ++i)
            values[table.columns[i]] = std::get<double>(cells[i]);
        if (const storage::CaseDigest* digest = index.find(plan.cases[row].id)) {
            for (const Remark& warning : digest->warnings)
                warned.push_back(warnings[storage::warning_text(warning)]);
            for (const storage::IndexedScalar& scalar : digest->scalars)
                if (!scalar.note.empty()) notes[scalar.name.text()] = reasons[scalar.note.text()];
        }
        lines += (row > 0 ? ",\n" : "") + Json({{"id", plan.cases[row].id},
                                                {"status", std::get<std::string>(cells[end + 2])},
                                                {"valid", std::get<std::string>(cells[end])},
                                                {"note", std::get<std::string>(cells[end + 3])},
                                                {"wall_s", std::get<double>(cells[end + 1])},
                                                {"values", values},
                                                {"notes", notes},
                                                {"warnings", warned}})
                                              .dump();
        // Growth would need the old and the new memory at the same time.
        if (row == 0) lines.reserve(lines.size() * (table.rows.size() + 1));
    }
    lines += fmt::format("\n],\n\"notes\": {},\n\"reasons\": {},\n\"warnings\": [{}]}}\n",
                         Json(table.notes).dump(), Json(reasons.texts()).dump(),
                         fmt::join(warnings.texts(), ", "));
    return lines;
}

/// The warnings of a case, with their severity and key, and the reasons for empty cells and limits
/// of values, with the columns grouped by reason.
std::vector<std::string> remarks_of(const storage::CaseDigest& digest) {
    std::vector<std::string> remarks;
    for (const Remark& w : digest.warnings)
        remarks.push_back(fmt::format("{}: {}: {}",
                                      w.severity == Severity::error ? "not valid" : "warning",
                                      w.key, w.message));
    std::vector<std::pair<std::string, std::string>> by_reason; // reason, labels of columns
    for (const storage::IndexedScalar& v : digest.scalars) {
        if (v.note.empty()) continue;
        auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                 [&](const auto& entry) { return v.note == entry.first; });
        if (same == by_reason.end()) same = by_reason.insert(same, {v.note.text(), ""});
        same->second += (same->second.empty() ? "" : ", ") + label_of(v.name.text());
    }
    for (const auto& [reason, labels] : by_reason)
        remarks.push_back(labels + ": " + reason);
    return remarks;
}

CaseRow read_row(const storage::IndexedCase& c, const storage::JournalContents& journal,
                 storage::CaseIndex& index) {
    CaseRow row;
    if (const storage::CaseDigest* digest = index.find(c.id)) {
        row.status = digest->status;
        row.digest = digest;
        row.remarks =
            digest->is_complete() ? remarks_of(*digest) : std::vector<std::string>{digest->damage};
        row.wall_s = digest->wall_s;
        if (digest->is_complete()) row.valid = digest->is_valid() ? "yes" : "no";
        return row;
    }
    const auto history = journal.cases.find(c.id);
    const bool failed = history != journal.cases.end() &&
                        history->second.state == storage::CaseHistory::State::failed;
    row.status = failed ? "failed" : "missing";
    row.remarks = {failed ? history->second.reason : "not computed"};
    return row;
}

Cell cell_of(const storage::IndexedCase& c, const std::string& key) {
    for (const Setting& setting : c.settings)
        if (setting.key == key)
            return std::visit([](const auto& v) { return Cell(v); }, setting.value);
    return not_a_number;
}

/// Ratios to the unmodulated reference, the effect of a modulation, and the columns that they
/// divide.
std::map<std::string, std::string> ratio_columns() {
    std::map<std::string, std::string> found;
    for (const measures::Measure& measure : measures::all_measures())
        if (*measure.over_reference_of) found.emplace(measure.name, measure.over_reference_of);
    return found;
}

/// Measures over periods, then ratios, then readings at one instant.
std::vector<std::string> in_table_order(std::vector<std::string> measures,
                                        const std::map<std::string, std::string>& ratios) {
    for (const auto& [name, of] : ratios)
        measures.push_back(name);
    std::stable_partition(measures.begin(), measures.end(),
                          [](const std::string& name) { return !measures::is_at_instant(name); });
    return measures;
}

/// A measure divided by that of the reference; NaN without one.
double ratio(const CaseRow& row, const CaseRow* reference, const std::string& measure) {
    return reference ? row.value(measure) / reference->value(measure) : not_a_number;
}

Table build_table(const ReduceInput& input, const storage::PlanIndex& plan,
                  storage::CaseIndex& index) {
    const storage::JournalContents journal = storage::read_journals(input.folder);
    std::vector<CaseRow> rows;
    std::map<std::string, std::size_t> by_id;
    std::vector<std::string> measures; // of all cases, in the order of the files
    std::unordered_set<std::string> known;
    Numbering notes;
    for (const storage::IndexedCase& c : plan.cases) {
        by_id[c.id] = rows.size();
        rows.push_back(read_row(c, journal, index));
        if (!rows.back().digest) continue;
        for (const storage::IndexedScalar& v : rows.back().digest->scalars)
            if (known.insert(v.name.text()).second) measures.push_back(v.name.text());
    }
    index.save();
    const std::map<std::string, std::string> ratios = ratio_columns();
    measures = in_table_order(std::move(measures), ratios);

    Table table;
    table.columns = {"id", "reference"};
    table.columns.insert(table.columns.end(), plan.swept_keys.begin(), plan.swept_keys.end());
    table.columns.insert(table.columns.end(), measures.begin(), measures.end());
    table.columns.insert(table.columns.end(), {"valid", "wall_s", "status", "note"});

    for (std::size_t i = 0; i < rows.size(); ++i) {
        const storage::IndexedCase& c = plan.cases[i];
        std::vector<Cell> cells;
        cells.reserve(table.columns.size());
        cells.emplace_back(c.id);
        cells.emplace_back(c.is_reference ? "yes" : "");
        for (const std::string& key : plan.swept_keys)
            cells.push_back(cell_of(c, key));
        const auto reference = by_id.find(c.reference_id);
        for (const std::string& name : measures) {
            const auto of = ratios.find(name);
            const CaseRow* divisor = reference == by_id.end() ? nullptr : &rows[reference->second];
            cells.emplace_back(of == ratios.end() ? rows[i].value(name)
                                                  : ratio(rows[i], divisor, of->second));
        }
        if (rows[i].valid == "yes" && reference != by_id.end() &&
            rows[reference->second].valid == "no")
            rows[i].remarks.push_back(fmt::format("ratios to the reference are not valid, since "
                                                  "the readings of the reference {} are not",
                                                  c.reference_id));
        cells.emplace_back(rows[i].valid);
        cells.emplace_back(rows[i].wall_s);
        cells.emplace_back(rows[i].status);
        std::vector<std::size_t> numbers;
        for (const std::string& remark : rows[i].remarks)
            numbers.push_back(notes[remark]);
        cells.emplace_back(fmt::format("{}", fmt::join(numbers, ", ")));
        table.rows.push_back(std::move(cells));
    }
    table.notes = notes.texts();
    return table;
}

/// The names of the columns of a measure: those of the table if the name has {words} in braces.
std::vector<std::string> columns_of(const measures::Measure& measure, const Table& table) {
    const std::string name = measure.name;
    if (name.find('{') == std::string::npos) return {name};
    std::vector<std::string> names;
    for (const std::string& column : table.columns)
        if (measures::find_measure(column) == &measure) names.push_back(column);
    return names;
}

/// Writes the statistics of a sample, and its sensitivity indices if the design has them.
void write_uncertain(const storage::PlanIndex& plan, const Table& table,
                     const std::filesystem::path& folder, ReducedTables& written) {
    std::vector<std::string> columns;
    for (const measures::Measure& measure : measures::all_measures())
        if (measure.shown != measures::Shown::csv)
            std::ranges::copy(columns_of(measure, table), std::back_inserter(columns));
    const UncertainTables tables = uncertain_tables(plan, table, columns);
    written.statistics = folder / (plan.name + ".statistics.csv");
    storage::write_file(written.statistics, csv(tables.statistics));
    const std::filesystem::path sensitivity = folder / (plan.name + ".sensitivity.csv");
    if (tables.sensitivity.rows.empty()) {
        std::error_code ignored;
        std::filesystem::remove(sensitivity, ignored);
        return;
    }
    written.sensitivity = sensitivity;
    storage::write_file(sensitivity, csv(tables.sensitivity));
}

/// Whether the first line of an existing table names a column of errors.
bool has_error_columns(const std::filesystem::path& path) {
    std::ifstream file(path);
    std::string line;
    if (!next_line(file, line)) return false;
    std::istringstream names(line);
    for (std::string name; next_line(names, name, ',');)
        if (measures::find_measure(column_of_error(name))) return true;
    return false;
}

/// A sentence below a table in which levels of loads at rest stand next to those of loads that
/// move, since the model has ranked these wrongly; empty without such levels.
std::string caution(const storage::PlanIndex& plan, const Table& table) {
    const auto level = table.find("felt_path_dB");
    bool rests = false, moves = false;
    for (std::size_t row = 0; level && row < plan.cases.size(); ++row) {
        const Cell kind = cell_of(plan.cases[row], "load.modulation.kind");
        const auto* name = std::get_if<std::string>(&kind);
        const auto* value = std::get_if<double>(&table.rows[row][*level]);
        if (name && value && !std::isnan(*value)) (*name == "AM" ? rests : moves) = true;
    }
    return rests && moves
               ? "\nThe model fails where the level compares loads at rest with loads that "
                 "move, or LM with AM: see docs/explanation/user-studies.md.\n"
               : "";
}

/// The headlines of all cases, with the cautions that concern them.
std::string markdown_table(const storage::PlanIndex& plan, const Table& table) {
    std::vector<std::string> columns = {"id", "reference"};
    columns.insert(columns.end(), plan.swept_keys.begin(), plan.swept_keys.end());
    for (const measures::Measure& measure : measures::all_measures())
        if (measure.shown == measures::Shown::headlines)
            for (const std::string& name : columns_of(measure, table)) {
                columns.push_back(name);
                columns.push_back(error_column(name)); // omitted unless the table has it
            }
    std::stable_partition(columns.begin(), columns.end(),
                          [](const std::string& name) { return !measures::is_at_instant(name); });
    columns.insert(columns.end(), {"valid", "wall_s", "status", "note"});
    return "# " + markdown_text(plan.title.empty() ? plan.name : plan.title) + "\n\n" +
           markdown(table, columns) + caution(plan, table);
}

} // namespace

Table table_of(const ReduceInput& input) {
    storage::CaseIndex index(input.folder, storage::CaseIndex::Trust::checksum);
    return build_table(input, storage::read_plan(input.plan), index);
}

ReducedTables reduce(const ReduceInput& input) {
    const storage::PlanIndex plan = storage::read_plan(input.plan);
    storage::CaseIndex index(input.folder, storage::CaseIndex::Trust::checksum);
    const Table plain = build_table(input, plan, index);
    const Errors errors = input.errors.empty() ? Errors{} : read_errors(input.errors);
    std::optional<Table> with_all_errors; // a copy only if there are any
    if (!errors.empty()) with_all_errors = with_errors(plain, measure_columns(plan, plain), errors);
    const Table& extended = with_all_errors ? *with_all_errors : plain;
    ReducedTables written;
    written.csv = input.tables / (plan.name + ".csv");
    written.markdown = input.tables / (plan.name + ".md");
    const bool retains_errors = input.error_columns == ErrorColumns::as_before && !errors.empty() &&
                                has_error_columns(written.csv);
    const bool adds_errors = input.error_columns == ErrorColumns::added || retains_errors;
    if (adds_errors && errors.empty())
        throw UsageError(fmt::format("{} has no estimates of the numerical error: run shearwake "
                                     "converge with the job of this folder first",
                                     input.folder.string()));
    const Table& table = adds_errors ? extended : plain;
    for (const storage::IndexedCase& c : plan.cases) {
        const storage::CaseDigest* digest = index.find(c.id);
        if (digest && !digest->is_complete()) written.damaged.push_back(c.id);
        if (!digest || !digest->is_complete()) continue;
        if (!digest->is_valid()) ++written.not_valid;
        if (std::ranges::find(written.programs, digest->git_id) == written.programs.end())
            written.programs.push_back(digest->git_id);
    }
    storage::make_directory(input.tables);
    storage::write_file(written.csv, csv(table));
    storage::write_file(input.tables / (plan.name + ".json"),
                        json_text(plan, extended, index, input.meaning_of_errors));

    if (plan.uncertain) write_uncertain(plan, plain, input.tables, written);
    if (!plan.adaptive.empty()) {
        written.adaptive = input.tables / (plan.name + ".adaptive.csv");
        const AdaptiveStates states = adaptive_states(plan, plain);
        storage::write_file(written.adaptive, csv(states.table));
        for (const auto& axis : states.axes)
            written.points_to_add += axis.next.size();
    }

    storage::write_file(written.markdown, markdown_table(plan, table));
    std::vector<std::string> main = plan.swept_keys;
    if (main.size() > 3) main.resize(3);
    main.insert(main.end(), {"eta_period_1", "eta_period_over_reference_1", "peak_um",
                             "focal_rms_um", "valid"});
    written.first_rows = first_rows(plain, main, 5);
    written.rows = table.rows.size();
    const std::size_t status = table.columns.size() - 2;
    written.complete = static_cast<std::size_t>(
        std::count_if(table.rows.begin(), table.rows.end(), [&](const std::vector<Cell>& row) {
            return std::get<std::string>(row[status]) == "complete";
        }));
    return written;
}

} // namespace shearwake::reduce
