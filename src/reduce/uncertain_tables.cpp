// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/derived_tables.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "base/units.hpp"
#include "sampling/design.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <map>

namespace shearwake::reduce {
namespace {

/// The cases with one combination of swept values: the row in the table of each row of the design.
struct Group {
    std::vector<Cell> settings;
    std::map<std::size_t, std::size_t> rows;
};

/// The number of values that a quantile or a probability needs beyond it, and a mean in total.
constexpr double least_beyond = 10.0, least_values = 30.0;
/// Half the width of an interval beyond which an index is considered uncertain: absolute for Sobol
/// indices, relative to the largest mu_star for Morris measures.
constexpr double widest_index = 0.05, widest_effect = 0.2;
/// The beginning of a remark on a case whose readings are not valid, followed by the key.
constexpr std::string_view not_valid = "not valid: ";

class Evaluation {
public:
    Evaluation(const storage::PlanIndex& plan, const Table& table)
        : index_(plan), plan_(*plan.uncertain), table_(table), design_(sampling::design_of(plan_)) {
        for (const std::string& key : plan.swept_keys)
            if (std::ranges::find(plan_.keys, key) == plan_.keys.end()) swept_.push_back(key);
        collect(plan);
        result_.statistics.columns = head({"column", "statistic"});
        result_.sensitivity.columns = head({"column", "key", "index"});
    }

    void add(const std::string& column) {
        if (!has_values(column)) return;
        for (const Group& group : groups_) {
            add_statistics(group, column);
            if (design_.analysis != sampling::Analysis::distribution)
                add_sensitivity(group, column);
        }
    }

    UncertainTables take() { return std::move(result_); }

private:
    bool has_values(const std::string& column) const {
        const auto place = table_.find(column);
        return place && std::ranges::any_of(table_.rows, [&](const std::vector<Cell>& row) {
                   const auto* number = std::get_if<double>(&row[*place]);
                   return number && std::isfinite(*number);
               });
    }

    std::vector<std::string> head(const std::vector<std::string>& own) const {
        std::vector<std::string> columns = swept_;
        columns.insert(columns.end(), own.begin(), own.end());
        columns.insert(columns.end(),
                       {"value", "low_95", "high_95", "samples", "without_value", "note"});
        return columns;
    }

    void collect(const storage::PlanIndex& plan) {
        for (std::size_t i = 0; i < plan.cases.size(); ++i) {
            if (!plan.cases[i].sample) continue;
            std::vector<Cell> settings;
            for (const std::string& key : swept_)
                settings.push_back(table_.rows[i][table_.find(key).value()]);
            auto group = std::ranges::find_if(
                groups_, [&](const Group& g) { return same(g.settings, settings); });
            if (group == groups_.end()) group = groups_.insert(groups_.end(), {settings, {}});
            group->rows[*plan.cases[i].sample] = i;
        }
    }

    /// Empty cells (NaN) are equal.
    static bool same(const std::vector<Cell>& a, const std::vector<Cell>& b) {
        return std::ranges::equal(a, b, [](const Cell& x, const Cell& y) {
            const auto *u = std::get_if<double>(&x), *v = std::get_if<double>(&y);
            return (u && v && std::isnan(*u) && std::isnan(*v)) || x == y;
        });
    }

    /// NaN: no value, or readings that are not valid.
    double value(const Group& group, std::size_t design_row, const std::string& column) const {
        const auto row = group.rows.find(design_row);
        return row == group.rows.end() ? not_a_number
                                       : valid_value(index_, table_, row->second, column);
    }

    /// Why the case of a design row has no value: the keys of the errors for which it is not valid,
    /// or its status.
    std::vector<std::string> reasons(const Group& group, std::size_t design_row) const {
        const auto row = group.rows.find(design_row);
        if (row == group.rows.end()) return {"missing"};
        std::vector<std::string> keys;
        for (const std::string& sentence : table_.note(row->second)) {
            if (!sentence.starts_with(not_valid)) continue;
            const std::string reason = sentence.substr(not_valid.size());
            keys.push_back(reason.substr(0, reason.find(": ")));
        }
        if (const auto status = table_.find("status"); keys.empty() && status)
            keys.push_back(std::get<std::string>(table_.rows[row->second][*status]));
        return keys;
    }

    /// "all 64 samples are invalid (domain.extent_mm: 64)", for samples that have no value: the
    /// first `rows` of each block of `step` rows of the design.
    std::string without_values(const Group& group, std::size_t rows, std::size_t step) const {
        std::map<std::string, std::size_t> counts;
        const std::size_t all = design_.samples * rows;
        const auto valid = table_.find("valid");
        std::size_t invalid = 0;
        for (std::size_t j = 0; j < design_.samples; ++j)
            for (std::size_t r = 0; r < rows; ++r) {
                const auto row = group.rows.find(j * step + r);
                invalid += row != group.rows.end() && valid &&
                           table_.rows[row->second][*valid] == Cell(std::string("no"));
                for (const std::string& reason : reasons(group, j * step + r))
                    ++counts[reason];
            }
        std::vector<std::string> parts;
        for (const auto& [reason, count] : counts)
            parts.push_back(fmt::format("{}: {}", reason, count));
        return fmt::format("{} ({})",
                           invalid == all ? fmt::format("all {} samples are invalid", all)
                                          : fmt::format("none of {} samples has a value", all),
                           fmt::join(parts, ", "));
    }

    void put(Table& out, const Group& group, std::vector<Cell> own, const Estimate& e,
             std::size_t values, std::size_t all, const std::string& note) const {
        std::vector<Cell> row = group.settings;
        row.insert(row.end(), own.begin(), own.end());
        row.insert(row.end(), {e.value, e.low, e.high, static_cast<double>(values),
                               static_cast<double>(all - values), note});
        out.rows.push_back(std::move(row));
    }

    /// The rows that are independent points of the distribution: all, A and B, or A.
    std::size_t independent_rows() const {
        return design_.analysis == sampling::Analysis::sobol_indices ? 2 : 1;
    }

    void add_statistics(const Group& group, const std::string& column) {
        const std::size_t step = rows_per_sample(design_);
        std::vector<double> values, thresholds;
        for (std::size_t j = 0; j < design_.samples; ++j)
            for (std::size_t r = 0; r < independent_rows(); ++r)
                if (const double v = value(group, j * step + r, column); std::isfinite(v))
                    values.push_back(v);
        for (const Threshold& threshold : plan_.exceedance)
            if (threshold.column == column) thresholds.push_back(threshold.value);
        const auto n = static_cast<double>(values.size());
        for (const Estimate& e : distribution_of(values, thresholds)) {
            const bool is_tail = e.name == "q05" || e.name == "q95";
            const bool exceeds = e.name.starts_with("exceeds");
            const double beyond = is_tail   ? 0.05 * n
                                  : exceeds ? n * std::min(e.value, 1.0 - e.value)
                                            : least_beyond;
            std::string note;
            if (values.empty())
                note = without_values(group, independent_rows(), step);
            else if (n < least_values)
                note = fmt::format("too few samples: {}; at least {} are required",
                                   counted(values.size(), "value"), least_values);
            else if (beyond < least_beyond)
                note = fmt::format("too few samples: {} beyond this {}; at least {} are required",
                                   counted(static_cast<std::ptrdiff_t>(beyond), "value"),
                                   exceeds ? "threshold" : "quantile", least_beyond);
            put(result_.statistics, group, {column, e.name}, e, values.size(),
                design_.samples * independent_rows(), note);
        }
    }

    void add_sensitivity(const Group& group, const std::string& column) {
        const std::size_t step = rows_per_sample(design_);
        const bool is_morris = design_.analysis == sampling::Analysis::morris;
        const sampling::Points all =
            is_morris ? sampling::design_points(design_) : sampling::Points{};
        Blocks blocks;
        bool has_value = false;
        std::vector<std::vector<std::vector<double>>> points;
        for (std::size_t j = 0; j < design_.samples; ++j) {
            std::vector<double> block(step);
            for (std::size_t r = 0; r < step; ++r)
                block[r] = value(group, j * step + r, column);
            has_value |= std::ranges::any_of(block, [](double v) { return std::isfinite(v); });
            if (std::ranges::any_of(block, [](double v) { return !std::isfinite(v); })) continue;
            blocks.push_back(std::move(block));
            if (is_morris) {
                const auto first = all.begin() + static_cast<std::ptrdiff_t>(j * step);
                points.emplace_back(first, first + static_cast<std::ptrdiff_t>(step));
            }
        }
        const std::vector<Estimate> estimates = is_morris
                                                    ? morris_measures(blocks, points, design_.keys)
                                                    : sobol_indices(blocks, design_.keys);
        double scale = 1.0;
        if (is_morris) {
            scale = 0.0;
            for (const Estimate& e : estimates)
                if (e.name == "mu_star" && e.value > scale) scale = e.value;
        }
        const double widest = is_morris ? widest_effect * scale : widest_index;
        const std::size_t per_key = estimates.size() / design_.keys;
        for (std::size_t i = 0; i < estimates.size(); ++i) {
            const Estimate& e = estimates[i];
            const double half = (e.high - e.low) / 2.0;
            std::string note;
            if (blocks.empty())
                note = has_value ? fmt::format("too few samples: none of them has a value in all "
                                               "of its {} cases",
                                               step)
                                 : without_values(group, step, step);
            else if (half > widest)
                note = fmt::format("too few samples: the interval is +- {:.2g}; increase "
                                   "uncertain.samples",
                                   half);
            put(result_.sensitivity, group, {column, plan_.keys[i / per_key], e.name}, e,
                blocks.size(), design_.samples, note);
        }
    }

    const storage::PlanIndex& index_;
    const UncertainPlan& plan_;
    const Table& table_;
    sampling::Design design_;
    std::vector<std::string> swept_;
    std::vector<Group> groups_;
    UncertainTables result_;
};

} // namespace

UncertainTables uncertain_tables(const storage::PlanIndex& plan, const Table& table,
                                 std::vector<std::string> columns) {
    for (const Threshold& threshold : plan.uncertain->exceedance) {
        if (!table.find(threshold.column)) {
            const auto meant = nearest(threshold.column, table.columns);
            throw UsageError(fmt::format(
                "uncertain.exceedance: the table has no column \"{}\"{}", threshold.column,
                meant ? fmt::format("; did you mean \"{}\"?", *meant) : ""));
        }
        if (std::ranges::find(columns, threshold.column) == columns.end())
            columns.push_back(threshold.column);
    }
    Evaluation evaluation(plan, table);
    for (const std::string& column : columns)
        evaluation.add(column);
    return evaluation.take();
}

} // namespace shearwake::reduce
