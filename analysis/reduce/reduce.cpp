#include "reduce/reduce.hpp"

#include "io/case_index.hpp"
#include "io/files.hpp"
#include "io/journal.hpp"
#include "io/plan_file.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

namespace shearwake {
namespace {

constexpr double nothing = std::numeric_limits<double>::quiet_NaN();

/// A case as its file, or what there is instead of it, tells.
struct CaseRow {
    std::string status, note;
    double wall_s = nothing;
    std::vector<IndexedScalar> scalars;

    double value(const std::string& name) const {
        for (const IndexedScalar& v : scalars)
            if (v.name == name) return v.value;
        return nothing;
    }
};

/// The reasons of empty cells, columns of one reason together.
std::string notes_of(const std::vector<IndexedScalar>& scalars) {
    std::vector<std::pair<std::string, std::string>> by_reason; // reason, columns
    for (const IndexedScalar& v : scalars) {
        if (v.note.empty() || !std::isnan(v.value)) continue;
        const auto same = std::find_if(by_reason.begin(), by_reason.end(),
                                       [&](const auto& entry) { return entry.first == v.note; });
        if (same == by_reason.end())
            by_reason.emplace_back(v.note, v.name);
        else
            same->second += ", " + v.name;
    }
    std::string text;
    for (const auto& [reason, columns] : by_reason)
        text += (text.empty() ? "" : "; ") + columns + ": " + reason;
    return text;
}

CaseRow read_row(const IndexedCase& c, const JournalContents& journal, CaseIndex& index) {
    CaseRow row;
    if (const CaseDigest* digest = index.find(c.id)) {
        row.status = digest->status;
        row.scalars = digest->scalars;
        row.note = digest->whole() ? notes_of(row.scalars) : digest->damage;
        row.wall_s = digest->wall_s;
        return row;
    }
    const auto history = journal.cases.find(c.id);
    const bool failed =
        history != journal.cases.end() && history->second.state == CaseHistory::State::failed;
    row.status = failed ? "failed" : "missing";
    row.note = failed ? history->second.reason : "not computed";
    return row;
}

Cell cell_of(const IndexedCase& c, const std::string& key) {
    for (const Setting& setting : c.settings)
        if (setting.key == key)
            return std::visit([](const auto& v) { return Cell(v); }, setting.value);
    return nothing;
}

/// Measures whose ratio to the unmodulated reference says what a modulation does.
const std::vector<std::pair<std::string, std::string>> ratios = {
    {"eta_period_1", "eta_period_over_reference_1"},
    {"focal_rms_um", "focal_rms_over_reference_1"},
};

Table build_table(const ReduceInput& input, const PlanIndex& plan, CaseIndex& index) {
    const JournalContents journal = read_journals(input.folder);
    std::vector<CaseRow> rows;
    std::map<std::string, std::size_t> by_id;
    std::vector<std::string> measures; // of all cases, in the order of the files
    for (const IndexedCase& c : plan.cases) {
        by_id[c.id] = rows.size();
        rows.push_back(read_row(c, journal, index));
        for (const IndexedScalar& v : rows.back().scalars)
            if (std::find(measures.begin(), measures.end(), v.name) == measures.end())
                measures.push_back(v.name);
    }
    index.save();

    Table table;
    table.columns = {"id", "reference"};
    table.columns.insert(table.columns.end(), plan.swept_keys.begin(), plan.swept_keys.end());
    table.columns.insert(table.columns.end(), measures.begin(), measures.end());
    for (const auto& [measure, ratio] : ratios)
        table.columns.push_back(ratio);
    table.columns.insert(table.columns.end(), {"wall_s", "status", "note"});

    for (std::size_t i = 0; i < rows.size(); ++i) {
        const IndexedCase& c = plan.cases[i];
        std::vector<Cell> cells = {c.id, c.is_reference ? std::string("yes") : std::string()};
        for (const std::string& key : plan.swept_keys)
            cells.push_back(cell_of(c, key));
        for (const std::string& name : measures)
            cells.emplace_back(rows[i].value(name));
        const auto reference = by_id.find(c.reference_id);
        for (const auto& [measure, ratio] : ratios)
            cells.emplace_back(reference == by_id.end()
                                   ? nothing
                                   : rows[i].value(measure) /
                                         rows[reference->second].value(measure));
        cells.emplace_back(rows[i].wall_s);
        cells.emplace_back(rows[i].status);
        cells.emplace_back(rows[i].note);
        table.rows.push_back(std::move(cells));
    }
    return table;
}

} // namespace

Table table_of(const ReduceInput& input) {
    CaseIndex index(input.folder);
    return build_table(input, read_plan(input.plan), index);
}

ReducedTables reduce(const ReduceInput& input) {
    const PlanIndex plan = read_plan(input.plan);
    CaseIndex index(input.folder);
    const Table table = build_table(input, plan, index);
    ReducedTables written;
    for (const IndexedCase& c : plan.cases) {
        const CaseDigest* digest = index.find(c.id);
        if (!digest || !digest->whole()) continue;
        if (std::ranges::find(written.programs, digest->git_id) == written.programs.end())
            written.programs.push_back(digest->git_id);
    }
    make_directory(input.tables);
    written.csv = input.tables / (plan.name + ".csv");
    written.markdown = input.tables / (plan.name + ".md");
    write_file(written.csv, csv(table));

    std::vector<std::string> columns = {"id", "reference"};
    columns.insert(columns.end(), plan.swept_keys.begin(), plan.swept_keys.end());
    for (const char* name :
         {"eta_at_1", "eta_period_1", "eta_period_over_reference_1", "ipr_at_1", "ipr_period_1",
          "ipr_abs_period_mm2", "participation_period_mm2", "peak_um", "focal_rms_um",
          "focal_rms_over_reference_1", "impulse_mN_ms", "peak_frequency_Hz", "rms_40_400_um",
          "mach_angle_deg", "wall_s", "status", "note"})
        columns.emplace_back(name);
    write_file(written.markdown, "# " + plan.title + "\n\n" + markdown(table, columns));

    written.rows = table.rows.size();
    const std::size_t status = table.columns.size() - 2;
    written.whole = static_cast<std::size_t>(
        std::count_if(table.rows.begin(), table.rows.end(), [&](const std::vector<Cell>& row) {
            return std::get<std::string>(row[status]) == "complete";
        }));
    return written;
}

} // namespace shearwake
