// SPDX-License-Identifier: BSD-3-Clause
#include "config/sweep/sweep.hpp"

#include "config/document/presets.hpp"
#include "config/document/reader.hpp"
#include "config/files/files.hpp"
#include "config/sections/read_case.hpp"
#include "config/sweep/sweep_remarks.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <unordered_map>
#include <unordered_set>

namespace shearwake::config {

namespace {

constexpr std::string_view modulation_prefix = "load.modulation.";

/// After this number of invalid cases, further cases are not read.
constexpr std::size_t most_bad_cases = 100;
/// Samples of a distribution are invalid for the same reason.
constexpr std::size_t most_bad_samples = 2;
/// Largest number of numbers in long lists of all cases: 160 MB.
constexpr double most_numbers = 2e7;

/// The index of the value on each axis; the last one changes fastest.
class Odometer {
public:
    explicit Odometer(const Sweep& sweep) : sweep_(sweep), at_(sweep.axes.size(), 0) {}
    std::size_t operator[](std::size_t axis) const { return at_[axis]; }
    bool advance() {
        for (std::size_t axis = at_.size(); axis-- > 0;) {
            if (++at_[axis] < sweep_.axes[axis].size()) return true;
            at_[axis] = 0;
        }
        return false;
    }

private:
    const Sweep& sweep_;
    std::vector<std::size_t> at_;
};

Setting setting(const std::string& key, const Node& node) {
    if (const auto number = as_number(node)) return {key, *number};
    if (const auto* word = std::get_if<std::string>(&node.value)) return {key, *word};
    return {key, render(node)};
}

class Expander {
public:
    Expander(const Sweep& sweep, const NodePtr& reference, const FileLoaders& files,
             DiagnosticList& diagnostics)
        : sweep_(sweep), reference_(reference), files_(files), diagnostics_(diagnostics),
          excluded_(sweep.exclusions.size(), 0) {
        double count = 1.0;
        for (const Axis& axis : sweep.axes)
            count *= static_cast<double>(axis.size());
        cases_.reserve(static_cast<std::size_t>(std::min(count, static_cast<double>(most_cases))));
    }

    void add(const NodePtr& base, const Odometer& wheel) {
        if (is_excluded(wheel)) return;
        const std::size_t before = diagnostics_.errors();
        const NodePtr root = chosen(base, wheel);
        if (!root) {
            ++bad_cases_;
            return;
        }
        auto c = read_case(root, sweep_.varies_kind ? OtherKinds::ignored : OtherKinds::refused,
                           files_, diagnostics_);
        if (!c || diagnostics_.errors() != before) {
            ++bad_cases_;
            return;
        }
        remarks_.add(*c, root);
        numbers_ += hashed_numbers(*c);
        std::string id = case_id(*c);
        PlannedCase planned{
            .id = std::move(id), .physics = *std::move(c), .settings = settings(wheel)};
        if (sweep_.sampled_axis) planned.sample = wheel[*sweep_.sampled_axis];
        if (reference_) planned.reference_id = add_reference(root, planned.settings);
        note_twin(planned);
        cases_.push_back(std::move(planned));
    }

    bool gives_up() const {
        return bad_cases_ > (sweep_.sampled_axis ? most_bad_samples : most_bad_cases) ||
               is_too_large() || cases_.size() + references_.size() > most_cases;
    }

    std::vector<PlannedCase> finish(bool complete) {
        remarks_.report(diagnostics_);
        if (cases_.size() + references_.size() > most_cases)
            diagnostics_.error(sweep_.at,
                               fmt::format("sweep: has more than {} cases with the references of "
                                           "its cases; divide it into several jobs",
                                           most_cases));
        if (is_too_large())
            diagnostics_.error(sweep_.at,
                               fmt::format("sweep: each case has lists of {:.0f} numbers, such as "
                                           "points of a path or of a scan, and all cases together "
                                           "may have {:.0e}; use fewer points or cases",
                                           numbers_ / static_cast<double>(cases_.size()),
                                           most_numbers));
        if (twins_ > 1) twin_message_ += fmt::format(" (and {} more such pairs)", twins_ - 1);
        if (twins_ > 0) diagnostics_.error(sweep_.at, twin_message_);
        for (std::size_t i = 0; complete && i < excluded_.size(); ++i)
            if (excluded_[i] == 0)
                diagnostics_.warning(sweep_.exclusions[i].at,
                                     "sweep.exclude: this entry matches no case and has no effect");
        if (bad_cases_ > 0 && sweep_.sampled_axis)
            diagnostics_.error(sweep_.axes[*sweep_.sampled_axis].keys.front().at,
                               "uncertain: no case is possible with some of the samples; if the "
                               "reason is the value of an uncertain key, truncate its "
                               "distribution with min and max");
        if (complete && cases_.empty() && bad_cases_ == 0)
            diagnostics_.error(sweep_.at, "sweep.exclude removes all cases");
        for (PlannedCase& reference : references_)
            if (!ordinary_.contains(reference.id)) cases_.push_back(std::move(reference));
        return std::move(cases_);
    }

private:
    bool is_too_large() const { return numbers_ > most_numbers; }

    bool is_excluded(const Odometer& wheel) {
        bool any = false;
        for (std::size_t i = 0; i < sweep_.exclusions.size(); ++i) {
            const auto& values = sweep_.exclusions[i].values;
            const bool all = std::all_of(values.begin(), values.end(), [&](const auto& wanted) {
                const NodePtr value = value_of(wanted.first, wheel);
                return value && same_value(*value, *wanted.second);
            });
            if (all) ++excluded_[i];
            any = any || all;
        }
        return any;
    }

    NodePtr value_of(const std::string& name, const Odometer& wheel) const {
        for (std::size_t axis = 0; axis < sweep_.axes.size(); ++axis)
            for (const SweptKey& key : sweep_.axes[axis].keys)
                if (key.key == name) return key.values[wheel[axis]];
        return nullptr;
    }

    /// The job with this combination of values applied, or null and a diagnostic.
    NodePtr chosen(const NodePtr& base, const Odometer& wheel) {
        NodePtr root = base;
        for (std::size_t axis = 0; axis < sweep_.axes.size(); ++axis) {
            for (const SweptKey& key : sweep_.axes[axis].keys) {
                std::string problem;
                root = with(root, key.path, key.values[wheel[axis]], key.at, problem);
                if (root) continue;
                diagnostics_.error(key.at,
                                   fmt::format("sweep: {} does not exist: {}", key.key, problem));
                return nullptr;
            }
        }
        return root;
    }

    std::vector<Setting> settings(const Odometer& wheel) const {
        std::vector<Setting> out;
        for (std::size_t axis = 0; axis < sweep_.axes.size(); ++axis)
            for (const SweptKey& key : sweep_.axes[axis].keys)
                out.push_back(setting(key.key, *key.values[wheel[axis]]));
        return out;
    }

    /// Whether the reference is independent of this swept key.
    bool is_idle_in_reference(const std::string& key, const std::string& kind) const {
        if (!key.starts_with(modulation_prefix)) return false;
        const std::string_view name = std::string_view(key).substr(modulation_prefix.size());
        // A key in the reference also replaces all keys below it.
        const std::string_view first_part = name.substr(0, name.find_first_of(".["));
        return key == kind_key || std::get<TableNode>(reference_->value).find(first_part) ||
               !has_meaning(name, kind);
    }

    /// The id of the case that `root` is compared with; empty after an error.
    std::string add_reference(NodePtr root, std::vector<Setting> settings) {
        for (const Entry& entry : std::get<TableNode>(reference_->value).entries) {
            std::string problem;
            root = with(root, {{"load"}, {"modulation"}, {entry.key}}, entry.value, entry.key_at,
                        problem);
        }
        // What is missing, is missing there.
        if (const NodePtr modulation = find(root, {{"load"}, {"modulation"}})) {
            std::string problem;
            const auto moved =
                std::make_shared<const Node>(Node{modulation->value, reference_->at});
            root = with(root, {{"load"}, {"modulation"}}, moved, reference_->at, problem);
        }
        const NodePtr kind = find(root, {{"load"}, {"modulation"}, {"kind"}});
        const auto* word = kind ? std::get_if<std::string>(&kind->value) : nullptr;
        std::erase_if(settings, [&](const Setting& s) {
            return is_idle_in_reference(s.key, word ? *word : "");
        });
        const auto [known, is_new] = reference_ids_.try_emplace(settings_text(settings), "");
        if (!is_new) return known->second;
        const auto c = read_case(root, OtherKinds::ignored, files_, diagnostics_);
        if (!c) {
            ++bad_cases_;
            return "";
        }
        known->second = case_id(*c);
        if (!seen_references_.insert(known->second).second) return known->second;
        remarks_.add(*c, root);
        references_.push_back({.id = known->second,
                               .physics = *c,
                               .settings = std::move(settings),
                               .is_reference = true});
        return known->second;
    }

    void note_twin(const PlannedCase& planned) {
        const auto [twin, is_new] = ordinary_.try_emplace(planned.id, cases_.size());
        if (is_new) return;
        if (twins_++ == 0)
            twin_message_ = fmt::format(
                "sweep: two combinations of values describe the same case: {{ {} }} "
                "and {{ {} }}; exclude one of them",
                settings_text(cases_[twin->second].settings), settings_text(planned.settings));
    }

    const Sweep& sweep_;
    NodePtr reference_;
    const FileLoaders& files_;
    DiagnosticList& diagnostics_;
    std::vector<std::size_t> excluded_; // number of cases that each exclusion has matched
    SweepRemarks remarks_;
    std::vector<PlannedCase> cases_, references_;
    std::unordered_map<std::string, std::size_t> ordinary_;      // by id
    std::unordered_map<std::string, std::string> reference_ids_; // by settings
    std::unordered_set<std::string> seen_references_;            // ids
    std::size_t bad_cases_ = 0, twins_ = 0;
    double numbers_ = 0.0; // in the long lists of all cases
    std::string twin_message_;
};

/// How many different footprints the cases can have at most.
double different_footprints(const Sweep& sweep) {
    double count = 1.0;
    for (const Axis& axis : sweep.axes)
        if (std::ranges::any_of(axis.keys, [](const SweptKey& swept) {
                return swept.key.starts_with("load.footprint");
            }))
            count *= static_cast<double>(axis.size());
    return count;
}

} // namespace

std::vector<PlannedCase> expand(const NodePtr& job, const Sweep& sweep, const NodePtr& reference,
                                const FileLoaders& files, DiagnosticList& diagnostics) {
    // Presets are expanded first, so that a sweep can change the layers of a preset.
    const NodePtr base = sweep.contains("medium.preset") ? job : with_medium_preset(job);
    Expander expander(sweep, reference, files, diagnostics);
    files.arrays->expected_1 = different_footprints(sweep);
    Odometer wheel(sweep);
    do {
        expander.add(base, wheel);
    } while (sweep.sound && !expander.gives_up() && wheel.advance());
    return expander.finish(sweep.sound && !expander.gives_up());
}

namespace {

/// A number, true, false or a word.
NodePtr value_in(std::string_view cell, const Place& at) {
    if (const auto number = finite_number_in(cell)) return make_node(*number, at);
    if (cell == "true" || cell == "false") return make_node(cell == "true", at);
    return make_node(std::string(cell), at);
}

/// The axis of a file, or the reason why it was rejected.
struct Listed {
    Axis axis;
    std::string problem;
};

std::string bad_cell(const CsvReader& reader, const Axis& axis) {
    const auto& cells = reader.cells();
    if (cells.size() != axis.keys.size())
        return fmt::format("has {} values, but the first line names {} keys", cells.size(),
                           axis.keys.size());
    for (std::size_t k = 0; k < cells.size(); ++k)
        if (cells[k].empty() || (number_in(cells[k]) && !finite_number_in(cells[k])))
            return fmt::format("the value of {} is \"{}\"; a number or a word is required",
                               axis.keys[k].key, excerpt(cells[k]));
    return "";
}

constexpr std::size_t most_listed_keys = 100;

Listed read_cases(std::string_view csv, const Place& at, DiagnosticList& diagnostics) {
    Listed listed;
    listed.problem = first_problem(csv, [&](const CsvReader& row) -> std::string {
        if (listed.axis.keys.empty()) {
            if (row.cells().size() > most_listed_keys)
                return fmt::format("exceeds the limit of {} keys", most_listed_keys);
            for (const std::string& key : row.cells()) {
                if (key.empty() || key == "Unnamed: 0")
                    return "has a column without a key; pandas writes its index as such a column, "
                           "unless index=False is given to to_csv()";
                if (std::ranges::find(listed.axis.keys, key, &SweptKey::key) !=
                    listed.axis.keys.end())
                    return fmt::format("names {} twice", key);
                const auto path = case_path({key, at, nullptr}, "sweep.list", diagnostics);
                listed.axis.keys.push_back({key, path.value_or(Path{}), at, {}});
            }
            return "";
        }
        if (std::string problem = bad_cell(row, listed.axis); !problem.empty()) return problem;
        if (listed.axis.size() == most_cases)
            return fmt::format("exceeds the limit of {} cases", most_cases);
        for (std::size_t k = 0; k < listed.axis.keys.size(); ++k)
            listed.axis.keys[k].values.push_back(value_in(row.cells()[k], at));
        return "";
    });
    if (!listed.problem.empty()) return {{}, listed.problem};
    if (listed.axis.keys.empty() || listed.axis.size() == 0)
        listed.problem = "must contain a line of full keys and a line of values per case";
    return listed;
}

} // namespace

void add_listed_cases(const NodePtr& sweep_node, Sweep& sweep, const FileLoaders& files,
                      DiagnosticList& diagnostics) {
    const auto* table = sweep_node ? std::get_if<TableNode>(&sweep_node->value) : nullptr;
    const Entry* entry = table ? table->find("list") : nullptr;
    if (!entry) return;
    const std::size_t before = diagnostics.errors();
    const Place& at = entry->value->at;
    Reader reader(sweep_node, "sweep", diagnostics);
    const auto text = load_named(reader, "list", files.load_text);
    Listed listed;
    if (text) listed = read_cases(*text, at, diagnostics);
    if (!listed.problem.empty())
        diagnostics.error(
            at, fmt::format("sweep.list: {} {}", excerpt(reader.word("list")), listed.problem));
    for (const SweptKey& key : listed.axis.keys)
        if (sweep.contains(key.key))
            diagnostics.error(at, fmt::format("sweep: {} is swept twice", key.key));
    sweep.sound = sweep.sound && diagnostics.errors() == before;
    if (sweep.sound) sweep.axes.push_back(std::move(listed.axis));
    check_sweep(sweep, diagnostics);
}

} // namespace shearwake::config
