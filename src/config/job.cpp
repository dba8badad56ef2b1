// SPDX-License-Identifier: BSD-3-Clause
#include "config/job.hpp"

#include "base/text.hpp"
#include "config/document/reader.hpp"
#include "config/sections/read_case.hpp"
#include "config/sweep/sweep.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <unordered_set>

namespace shearwake::config {
namespace {

/// [table]: the layout, and the changes that turn a case into its reference.
struct TableSection {
    TableOptions options;
    NodePtr reference; // keys of load.modulation; null: no reference
};

/// The keys of a sweep with errors are unknown, so nothing further is reported.
bool is_swept(const Reader& reader, std::string_view key, const std::string& word,
              const std::vector<std::string>& swept, const Sweep& sweep) {
    if (!sweep.sound || std::find(swept.begin(), swept.end(), word) != swept.end()) return true;
    const auto meant = word.size() < 100 ? nearest(word, swept) : std::nullopt;
    reader.error(key, fmt::format("contains \"{}\", which is not swept{}", excerpt(word),
                                  meant ? fmt::format("; did you mean \"{}\"?", *meant) : ""));
    return false;
}

/// The other keys on the axis of x are determined by x, unless x contains a value twice.
bool x_determines_all(const SweptKey& x) {
    std::unordered_set<std::string> values;
    for (const NodePtr& value : x.values)
        values.insert(render(*value));
    return values.size() == x.values.size();
}

std::vector<std::string> default_series(const Sweep& sweep, const std::string& x) {
    std::vector<std::string> series;
    for (const Axis& axis : sweep.axes) {
        const auto its_x = std::find_if(axis.keys.begin(), axis.keys.end(),
                                        [&](const SweptKey& key) { return key.key == x; });
        if (its_x != axis.keys.end() && x_determines_all(*its_x)) continue;
        for (const SweptKey& key : axis.keys)
            if (key.key != x) series.push_back(key.key);
    }
    return series;
}

/// The page of the report reads the labels from the job file; here they are checked only.
void check_labels(Reader labels, const std::vector<std::string>& swept, const Sweep& sweep) {
    for (const std::string& key : labels.keys()) {
        const auto texts = labels.find_words(key);
        if (!is_swept(labels, key, key, swept, sweep) || !texts || !sweep.sound) continue;
        for (const Axis& axis : sweep.axes)
            for (const SweptKey& of : axis.keys) {
                if (of.key != key) continue;
                std::unordered_set<std::string> values;
                for (const NodePtr& value : of.values)
                    values.insert(render(*value));
                if (values.size() != texts->size())
                    labels.error(key, fmt::format("has {} labels, but the key has {} values",
                                                  texts->size(), values.size()));
            }
    }
    labels.finish();
}

TableSection read_table(Reader reader, const Sweep& sweep) {
    const std::vector<std::string> swept = sweep.keys();
    TableSection table;
    const auto x = reader.find_word("x");
    const bool x_is_swept = x && is_swept(reader, "x", *x, swept, sweep);
    table.options.x = x_is_swept ? *x : swept.empty() ? "" : swept.front();
    if (const auto series = reader.find_words("series")) {
        for (const std::string& key : *series) {
            if (is_swept(reader, "series", key, swept, sweep) && key == table.options.x)
                reader.error("series", fmt::format("contains \"{}\", which is already x", key));
            if (std::count(series->begin(), series->end(), key) > 1)
                reader.error("series", fmt::format("contains \"{}\" twice", excerpt(key)));
        }
        table.options.series = *series;
    } else {
        table.options.series = default_series(sweep, table.options.x);
    }
    check_labels(reader.optional_table("labels"), swept, sweep);
    const NodePtr reference = reader.node("reference");
    if (!reader.optional_table("reference").empty()) table.reference = reference;
    if (table.reference && std::get<TableNode>(reference->value).entries.empty())
        reader.error("reference", "must change at least one key, for example { kind = \"STM\" }");
    reader.finish();
    return table;
}

constexpr std::size_t most_bytes = 2'500'000; // elements of two characters take 250 MB
constexpr std::size_t most_printed = 50;

std::string all_lines(const std::vector<Diagnostic>& diagnostics) {
    // Errors take precedence over warnings.
    std::size_t printed = 0, errors = 0;
    for (const Diagnostic& diagnostic : diagnostics)
        errors += diagnostic.severity == Severity::error;
    std::size_t room_for_warnings = most_printed - std::min(errors, most_printed);
    std::string lines;
    for (const Diagnostic& diagnostic : diagnostics) {
        const bool is_error = diagnostic.severity == Severity::error;
        if (!is_error && room_for_warnings == 0) continue;
        if (printed == most_printed) break;
        room_for_warnings -= is_error ? 0 : 1;
        if (!lines.empty()) lines += '\n';
        lines += text(diagnostic);
        ++printed;
    }
    if (printed < diagnostics.size())
        lines += fmt::format("\nand {} more", diagnostics.size() - printed);
    return lines;
}

void check_schema(Reader& root, const Place& at) {
    const NodePtr schema = root.node("schema");
    if (!schema) {
        root.diagnostics().error(at, "schema is missing; begin the job with the line schema = 1");
        return;
    }
    const auto* number = std::get_if<std::int64_t>(&schema->value);
    if (!number || *number != 1)
        root.error("schema",
                   fmt::format("must be 1, the only version that this program supports, but is {}",
                               excerpt(render(*schema))));
}

/// The name is used as a folder name and must not lead outside the output directory.
void check_name(const Reader& reader, const std::string& name) {
    if (is_file_name(name)) return;
    reader.error("name", fmt::format("must be a valid folder name: 1 to {} letters, digits, \"-\", "
                                     "\"_\" and \".\", not starting with \".\"; it is \"{}\"",
                                     longest_file_name, excerpt(name)));
}

void read_identity(Reader reader, Plan& plan) {
    const std::size_t before = reader.diagnostics().errors();
    plan.name = reader.word("name");
    plan.title = reader.find_word("title").value_or("");
    plan.answer = reader.find_word("answer").value_or("");
    reader.find_word("question"); // the report reads it from the text of the job
    const bool given = reader.has("name") && reader.diagnostics().errors() == before;
    reader.finish();
    if (given) check_name(reader, plan.name);
}

/// A crossing with the reference requires a reference.
void check_crossings(const Sweep& sweep, const TableSection& table, DiagnosticList& diagnostics) {
    for (const AdaptiveAxis& axis : sweep.adaptive)
        if (axis.goal == AdaptiveAxis::Goal::crossing && !axis.has_level && !table.reference)
            diagnostics.error(sweep.at,
                              fmt::format("sweep: {} requires a level to cross, or a reference in "
                                          "[table], for example reference = {{ kind = \"STM\" }}",
                                          axis.key));
}

/// A job with its overrides, the same without them, and the table [sweep] of the file.
struct ParsedJob {
    NodePtr tree, file, sweep;
};

/// Whether the file sweeps the kind of modulation.
bool varies_kind(const NodePtr& sweep_of_file, const FileLoaders& files) {
    DiagnosticList ignored; // errors are reported for the sweep that is used
    Sweep sweep = read_sweep(sweep_of_file, {}, ignored);
    add_listed_cases(sweep_of_file, sweep, files, ignored);
    return sweep.contains(kind_key);
}

Plan read_plan(const ParsedJob& parsed, std::span<const Override> overrides,
               const FileLoaders& files, const AxisPoints& points,
               std::optional<OptimiseOptions>& optimise, DiagnosticList& diagnostics) {
    Plan plan;
    const NodePtr& tree = parsed.tree;
    Reader root(tree, "", diagnostics);
    check_schema(root, tree->at);
    read_identity(root.table("job"), plan);
    root.allow(case_tables());
    Sweep sweep = read_sweep(root.node("sweep"), points, diagnostics);
    add_listed_cases(root.node("sweep"), sweep, files, diagnostics);
    const bool is_replaced = root.node("sweep") != parsed.sweep;
    sweep.varies_kind =
        sweep.contains(kind_key) || (is_replaced && varies_kind(parsed.sweep, files));
    const TableSection table = read_table(root.optional_table("table"), sweep);
    check_crossings(sweep, table, diagnostics);
    if (const NodePtr node = root.node("uncertain"))
        plan.uncertain = read_uncertain(node, sweep, files, diagnostics);
    optimise = read_optimise(root.optional_table("optimise"));
    root.finish();
    plan.swept_keys = sweep.keys();
    plan.table = table.options;
    plan.adaptive = sweep.adaptive;
    check_overrides(tree, overrides, plan.swept_keys, diagnostics);
    plan.cases = expand(tree, sweep, table.reference, files, diagnostics);
    return plan;
}

ParsedJob parse(std::string_view text, const std::string& file_name,
                std::span<const Override> overrides, DiagnosticList& diagnostics) {
    if (text.size() > most_bytes) {
        diagnostics.error({std::make_shared<const std::string>(file_name)},
                          fmt::format("the file has {} bytes, but a job file may have at most {}",
                                      text.size(), most_bytes));
        return {};
    }
    NodePtr tree = parse_toml(text, file_name, diagnostics);
    if (!tree) return {};
    const auto flatten = [&](const Path& path, const auto& flat) {
        std::string problem;
        if (const NodePtr table = find(tree, path))
            tree = with(tree, path, flat(table), place_of(tree, path), problem);
    };
    flatten({{"sweep"}}, flattened_sweep);
    flatten({{"uncertain"}}, flattened_uncertain);
    const NodePtr file = tree, sweep = find(tree, {{"sweep"}});
    for (const Override& override : overrides)
        tree = with_override(tree, override, diagnostics);
    return {tree, file, sweep};
}

} // namespace

NodePtr job_tree(std::string_view text, const std::string& file_name,
                 std::span<const Override> overrides, DiagnosticList& diagnostics) {
    return parse(text, file_name, overrides, diagnostics).tree;
}

BadJob::BadJob(std::vector<Diagnostic> diagnostics)
    : UsageError(all_lines(diagnostics), ExitCode::bad_job), diagnostics_(std::move(diagnostics)) {}

Job read_job(std::string_view text, const std::string& file_name,
             std::span<const Override> overrides, const MapLoader& load_map,
             const TextLoader& load_text, const AxisPoints& points) {
    DiagnosticList diagnostics;
    Job job{.text = std::string(text), .plan = {}, .diagnostics = {}};
    const ParsedJob parsed = parse(text, file_name, overrides, diagnostics);
    if (parsed.tree)
        job.plan = read_plan(parsed, overrides, {.load_map = load_map, .load_text = load_text},
                             points, job.optimise, diagnostics);
    job.diagnostics = diagnostics.sorted();
    if (diagnostics.errors() > 0) throw BadJob(std::move(job.diagnostics));
    if (!overrides.empty())
        job.text = text_with_overrides(parsed.file, parsed.tree, file_name, text);
    return job;
}

AfferentOptions read_afferent_options(std::string_view text, const std::string& file_name,
                                      std::span<const Override> overrides,
                                      const TextLoader& load_text) {
    DiagnosticList diagnostics;
    AfferentOptions options;
    if (const NodePtr tree = job_tree(text, file_name, overrides, diagnostics)) {
        Reader root(tree, "", diagnostics);
        root.allow(case_tables());
        root.allow(std::array<std::string_view, 4>{"schema", "job", "sweep", "table"});
        Reader afferents = root.optional_table("afferents");
        if (const auto read = read_afferents(afferents, Domain{}, nullptr, load_text))
            options = *read;
        root.finish();
    }
    if (diagnostics.errors() > 0) throw BadJob(diagnostics.sorted());
    return options;
}

} // namespace shearwake::config
