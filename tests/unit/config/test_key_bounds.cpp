// SPDX-License-Identifier: BSD-3-Clause
// Every bound of a number in the schema of jobs is that of the reader and of the reference: a value
// outside it is refused with its words, a value inside it is not, and the reference lists it. This
// includes the physical bounds of quantities. Relations between keys (low < high) and the numbers
// of points and cases that result from several keys have no place in a schema; only the reader
// checks them.
#include "base/field.hpp"
#include "base/json.hpp"
#include "config/document/key_range.hpp"
#include "config/job.hpp"
#include "config/keys/key_table.hpp"
#include "config/keys/schema_types.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace test_key_bounds {

using namespace shearwake;
using namespace shearwake::config;

/// A number of the schema: its place as a job text with a hole for the value, and its bounds.
struct Bounded {
    std::string key;           // "load.footprint.fwhm_mm"
    std::string before, after; // of the value, as TOML
    KeyRange allowed;
    bool is_integer = false;
};

/// What a key needs beside it before the reader looks at it; the first entry whose key begins the
/// name of the key applies.
const std::vector<std::pair<std::string, std::string>> beside = {
    {"vibrometer.grid_mm", "spacing_mm = 1"},
    {"vibrometer.polygon_mm", "spacing_mm = 1"},
    {"vibrometer.line_mm", "spacing_mm = 1"},
    {"vibrometer.spacing_mm", "grid_mm = [10, 10]"},
    {"afferents.carrier", "input = \"carrier\""},
    {"solver.pstd.displacement_um", "load = \"displacement\""},
    {"solver.pstd.velocity_mm_s", "load = \"velocity\""},
    {"solver.pstd.fluid_", "top = \"fluid\""},
    {"solver.pstd.device_number", "device = \"gpu\""},
    {"load.modulation.am_duty", "kind = \"AM\", am_wave = \"square\""},
    {"load.modulation.am_edge_us", "kind = \"AM\", am_wave = \"square\""},
    {"load.modulation.am_", "kind = \"AM\""},
    {"load.modulation.lm_", "kind = \"LM\""},
    {"load.modulation.speed_deviation_m_s", "kind = \"SM-STM\""},
    {"load.modulation.sm_", "kind = \"SM-STM\""},
    {"load.modulation.pattern", "kind = \"STP\""},
    {"load.modulation.trajectory[1]", ""},
    {"load.modulation.trajectory", "kind = \"custom\""},
    {"load.modulation.path", "kind = \"STM\""},
    {"load.modulation.position_mm", "kind = \"AM\""},
    {"load.modulation.",
     "kind = \"STM\", path = { shape = \"line\", from_mm = [0, 0], to_mm = [9, 0] }"},
};

class Walk {
public:
    explicit Walk(const Json& schema) : schema_(schema) {
        table(schema, "", "", "", {});
        table(schema.at("$defs").at("axis").at("anyOf").at(std::size_t{0}), "sweep.KEY",
              "sweep = { \"load.peak_Pa\" = { refine = [1, 2], ", " } }", {});
        table(schema.at("$defs").at("distribution").at("anyOf").at(std::size_t{0}), "uncertain.KEY",
              "uncertain = { \"load.peak_Pa\" = { distribution = \"normal\", ", " } }", {});
    }
    std::vector<Bounded> found;
    std::vector<std::string> short_lists; // jobs with a list that is too short

private:
    /// A member, or `otherwise`.
    static const Json& member(const Json& node, const char* name, const Json& otherwise) {
        const Json* found = node.find(name);
        return found == nullptr ? otherwise : *found;
    }
    static const Json& table_of(const Json& node, const char* name) {
        static const Json none = Json::object();
        return member(node, name, none);
    }
    static const Json& list_of(const Json& node, const char* name) {
        static const Json none = Json::array();
        return member(node, name, none);
    }

    void table(const Json& node, const std::string& key, const std::string& before,
               const std::string& after, std::string siblings, const Json& tighter = {}) {
        if (node.contains("$ref")) {
            const std::string name = node.at("$ref").get<std::string>();
            return table(schema_.at("$defs").at(name.substr(name.rfind('/') + 1)), key, before,
                         after, siblings, table_of(node, "properties"));
        }
        for (const auto& [name, content] : table_of(node, "properties").items())
            property(tighter.contains(name) ? tighter.at(name) : content, name, key, before, after,
                     siblings);
        for (const Json& rule : list_of(node, "allOf")) {
            if (!rule.contains("if") || !rule.contains("then")) continue;
            std::string chosen = siblings;
            for (const auto& [selector, is] : table_of(rule.at("if"), "properties").items())
                if (is.contains("const"))
                    chosen += fmt::format("{} = {}, ", selector, is.at("const").dump());
            table(rule.at("then"), key, before, after, chosen, tighter);
        }
    }

    void property(const Json& content, const std::string& name, const std::string& table_key,
                  const std::string& before, const std::string& after,
                  const std::string& siblings) {
        const std::string key = table_key.empty() ? name : table_key + "." + name;
        // The root table is not an inline one.
        const bool is_root = table_key.empty();
        std::string more = siblings;
        const auto extra = std::ranges::find_if(
            beside, [&](const auto& entry) { return key.starts_with(entry.first); });
        if (extra != beside.end() && !extra->second.empty()) more += extra->second + ", ";
        const std::string open = before + (is_root ? "" : more) + name + " = ";
        const Json* node = &content;
        for (const Json& option : list_of(content, "anyOf"))
            if (option.contains("type") && option.at("type") != "string") node = &option;
        if (node->value("type", std::string()) == "object" || node->contains("$ref"))
            table(*node, key, open + "{ ", " }" + after, "");
        else if (node->value("type", std::string()) == "array" && node->contains("items")) {
            const Json& item = node->at("items");
            const std::size_t least = node->value("minItems", std::size_t{0}),
                              most = node->value("maxItems", std::size_t{0});
            if (least > 0 && least != most) {
                std::string list;
                for (std::size_t i = 1; i < least; ++i)
                    list +=
                        is_number(item) ? fmt::format("0.{}, ", i) : fmt::format("[0.{}, 0], ", i);
                short_lists.push_back(open + "[" + list + "]" + after);
            }
            if (item.value("type", std::string()) == "object")
                table(item, key + "[1]", open + "[{ ", " }]" + after, "");
            else if (is_number(item))
                number(item, key, open + "[", (node->contains("minItems") ? ", %]" : "]") + after);
            else if (item.contains("items") && is_number(item.at("items")))
                number(item.at("items"), key, open + "[[", ", %]]" + after);
        } else if (is_number(*node))
            number(*node, key, open, after);
    }

    static bool is_number(const Json& node) {
        return node.value("type", std::string()) == "number" ||
               node.value("type", std::string()) == "integer";
    }

    void number(const Json& node, const std::string& key, const std::string& before,
                const std::string& after) {
        Bounded bounded{key, before, after, {}, node.at("type") == "integer"};
        Range& range = bounded.allowed.range;
        for (const auto& [bound, value] : node.items()) {
            if (bound == "minimum" || bound == "exclusiveMinimum") {
                range.least = value.get<double>();
                range.least_excluded = bound != "minimum";
            }
            if (bound == "maximum" || bound == "exclusiveMaximum") {
                range.most = value.get<double>();
                range.most_excluded = bound != "maximum";
            }
        }
        for (const Json& part : list_of(node, "anyOf"))
            bounded.allowed.least_size = part.value("minimum", bounded.allowed.least_size);
        found.push_back(bounded);
    }

    const Json& schema_;
};

/// The messages about a job, one per line.
static std::string messages(const std::string& job) {
    std::vector<Diagnostic> diagnostics;
    try {
        diagnostics = read_job("schema = 1\n" + job + "\n", "job.toml").diagnostics;
    } catch (const BadJob& bad) {
        diagnostics = bad.diagnostics();
    }
    std::string all;
    for (const Diagnostic& diagnostic : diagnostics)
        all += diagnostic.message + "\n";
    return all;
}

static std::string number_text(double value) {
    const std::string text = fmt::format("{}", value);
    return text.find_first_of(".e") == std::string::npos ? text + ".0" : text;
}

/// The reader's answers to a value.
struct Answers {
    bool names_bounds = false; // a refusal in the words of these bounds
    bool names_range = false;  // a refusal in the words of some range
    std::string all;           // the job and the messages
};

static Answers answers(const Bounded& b, double value) {
    const std::string text = b.is_integer ? fmt::format("{:.0f}", value) : number_text(value);
    std::string job = b.before + text + b.after;
    if (const std::size_t hole = job.find('%'); hole != std::string::npos)
        job.replace(hole, 1, text);
    const std::string start = b.key.substr(b.key.rfind('.') + 1) + " must be ";
    Answers found{.all = job + "\n" + messages(job)};
    std::istringstream lines(found.all);
    for (std::string message; std::getline(lines, message);) {
        const std::size_t at = message.find(start);
        if (at == std::string::npos) continue;
        std::string_view rest = std::string_view(message).substr(at + start.size());
        rest = rest.substr(0, rest.find(", but is"));
        if (std::ranges::any_of(std::array{", a ", ", the ", ", half of ", ", so that "},
                                [&](const char* words) { return rest.find(words) != rest.npos; }))
            continue; // a relation to another key
        found.names_bounds = found.names_bounds || rest.starts_with(b.allowed.words());
        for (const char* word : {"above ", "at least ", "at most ", "between ", "0 or ", "below "})
            found.names_range = found.names_range || rest.starts_with(word);
    }
    return found;
}

/// The reader refuses the value in the words of these bounds, or for none.
static void check_value(const Bounded& b, double value) {
    const Answers found = answers(b, value);
    INFO(b.key << ": " << b.allowed.words() << "\n" << found.all);
    CHECK(found.names_bounds != b.allowed.contains(value));
    CHECK(found.names_range == found.names_bounds);
}

/// Values at the bounds and next to them, and values that no quantity has.
static std::vector<double> probes(const Bounded& b) {
    std::vector<double> values;
    const auto around = [&](double bound) {
        if (!std::isfinite(bound)) return;
        // 2 is the spacing of numbers above 2^53.
        const double step = b.is_integer ? 2.0 : 1e-3 * (bound == 0.0 ? 1e-3 : std::abs(bound));
        values.insert(values.end(), {bound - step, bound, bound + step});
    };
    around(b.allowed.range.least);
    around(b.allowed.range.most);
    if (b.is_integer) return values;
    around(b.allowed.least_size);
    around(-b.allowed.least_size);
    values.insert(values.end(), {0.0, 1e-30, -1e-30, 1e30, -1e30});
    return values;
}

/// Whether a row of the reference has this key, perhaps with a prefix, and these values.
static bool has_row(const std::string& reference, const std::string& key,
                    const std::string& words) {
    if (words == Range{}.words()) return true;
    std::istringstream rows(reference);
    for (std::string row; std::getline(rows, row);) {
        const std::size_t name = row.find(key + "` |");
        const std::size_t values = row.find(words + " |");
        if (row.starts_with("| `") && name != std::string::npos && values != std::string::npos &&
            name < values)
            return true;
    }
    return false;
}

TEST_CASE("schema and reader and the reference agree on each bound", "[fields][schema]") {
    const Json schema = schema_of_jobs();
    const Walk walk(schema);
    const std::string reference = key_reference();
    std::size_t bounds = 0;
    for (const Bounded& b : walk.found) {
        bounds += std::isfinite(b.allowed.range.least);
        bounds += std::isfinite(b.allowed.range.most);
        for (const double value : probes(b))
            check_value(b, value);
        INFO(b.key);
        CHECK(has_row(reference, b.key.substr(b.key.rfind('.') + 1), b.allowed.words()));
    }
    CHECK(bounds >= 300);
    for (const std::string& job : walk.short_lists) {
        INFO(job);
        CHECK_THAT(messages(job), Catch::Contains("must contain") || Catch::Contains("but has"));
    }
    CHECK(walk.short_lists.size() >= 8);
}

TEST_CASE("the reference has ranges and defaults in the units of the keys", "[fields]") {
    for (const char* row :
         {"| `silence_ms` | 0 or between 1e-09 and 10000 | 20 |",
          "| `footprint.distance_mm` | between 20 and",
          "| `top` | `\"void\"`, `\"continued\"`, `\"fluid\"` | `\"void\"` |",
          "## `[[load.modulation.envelope]]` with `shape = \"square\"`", "## `[solver.pstd]`",
          "with `load = \"displacement\"`: displacement of the skin"})
        CHECK_THAT(key_reference(), Catch::Contains(row));
}

} // namespace test_key_bounds
