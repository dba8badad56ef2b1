// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/derived_tables.hpp"

#include "sampling/design.hpp"
#include "support/known_models.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <functional>
#include <numbers>

namespace test_sensitivity {

using namespace shearwake;

constexpr double pi = std::numbers::pi;
using Model = std::function<double(const std::vector<double>&)>;

/// Computes every case of a plan with a model of the unit cube instead of an engine, and evaluates
/// the table as `reduce` does. The plan sweeps `scale`, by which the model is multiplied.
class ModelRun {
public:
    ModelRun(const std::string& analysis, std::size_t samples, std::size_t keys, const Model& model,
             std::size_t failing = 0) {
        UncertainPlan uncertain{.sampling = "sobol",
                                .analysis = analysis,
                                .samples = samples,
                                .seed = 1,
                                .exceedance = {{"eta", 0.0}}};
        plan.name = "model";
        plan.swept_keys = {"scale"};
        for (std::size_t k = 0; k < keys; ++k) {
            uncertain.keys.push_back("x" + std::to_string(k + 1));
            plan.swept_keys.push_back(uncertain.keys.back());
        }
        const auto rows = sampling::design_points(sampling::design_of(uncertain));
        plan.uncertain = uncertain;
        table.columns = {"id", "scale", "eta"};
        for (const double scale : {1.0, 10.0})
            for (std::size_t r = 0; r < rows.size(); ++r) {
                const std::string id = std::to_string(plan.cases.size());
                plan.cases.push_back({.id = id, .sample = r});
                const bool fails = r < failing;
                table.rows.push_back({id, scale, fails ? std::nan("") : scale * model(rows[r])});
            }
        evaluated = reduce::uncertain_tables(plan, table, {"eta"});
    }

    struct Line {
        double value, low, high, samples, without;
        std::string note;
    };
    /// The line of a table whose first text cells after the scale are `words`.
    static Line line(const reduce::Table& table, double scale,
                     const std::vector<std::string>& words) {
        for (const auto& row : table.rows) {
            bool fits = std::get<double>(row[0]) == scale;
            for (std::size_t i = 0; i < words.size(); ++i)
                fits = fits && std::get<std::string>(row[1 + i]) == words[i];
            if (!fits) continue;
            const std::size_t at = 1 + words.size();
            const auto number = [&](std::size_t i) { return std::get<double>(row[at + i]); };
            return {number(0), number(1), number(2),
                    number(3), number(4), std::get<std::string>(row[at + 5])};
        }
        FAIL("no such line");
        return {};
    }

    storage::PlanIndex plan;
    reduce::Table table;
    reduce::UncertainTables evaluated;
};

static void check_index(const ModelRun& run, const std::string& key, const std::string& index,
                        double exact) {
    for (const double scale : {1.0, 10.0}) {
        const auto line = ModelRun::line(run.evaluated.sensitivity, scale, {"eta", key, index});
        INFO(key << " " << index << ": " << line.value << " in " << line.low << ".." << line.high);
        CHECK(std::abs(line.value - exact) < 0.02); // the documented accuracy at 4096 samples
        CHECK(line.low <= exact);
        CHECK(line.high >= exact);
    }
}

static void check_indices(const ModelRun& run, const std::string& key,
                          const test::KnownIndex& exact) {
    check_index(run, key, "first_order", exact.first_order);
    check_index(run, key, "total", exact.total);
}

TEST_CASE("the Sobol indices of the Ishigami function are found", "[reduce][sensitivity]") {
    const ModelRun run("sobol-indices", 4096, 3, test::ishigami);
    const std::vector<test::KnownIndex> known = test::ishigami_indices();
    for (std::size_t k = 0; k < known.size(); ++k)
        check_indices(run, "x" + std::to_string(k + 1), known[k]);
    const auto mean = ModelRun::line(run.evaluated.statistics, 1.0, {"eta", "mean"});
    CHECK(mean.value == Approx(3.5).margin(0.01)); // a / 2
    CHECK(mean.samples == 8192.0);
    CHECK(mean.note.empty());
    const auto sd = ModelRun::line(run.evaluated.statistics, 10.0, {"eta", "sd"});
    CHECK(sd.value == Approx(10.0 * std::sqrt(test::ishigami_variance())).epsilon(0.01));
}

TEST_CASE("the Sobol indices of the g-function are found", "[reduce][sensitivity]") {
    const std::vector<test::KnownIndex> known = test::g_indices();
    const ModelRun run("sobol-indices", 4096, known.size(), test::g_function);
    for (std::size_t k = 0; k < known.size(); ++k)
        check_indices(run, "x" + std::to_string(k + 1), known[k]);
}

TEST_CASE("a small sample of indices has a warning and wide intervals", "[reduce][sensitivity]") {
    const ModelRun run("sobol-indices", 16, 3, test::ishigami);
    const auto total = ModelRun::line(run.evaluated.sensitivity, 1.0, {"eta", "x1", "total"});
    CHECK(total.note.find("too few samples") == 0);
    CHECK(total.high - total.low > 0.1);
}

TEST_CASE("the interval of a probability has a width at 0 and 1", "[reduce][sensitivity]") {
    std::vector<double> values(32);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] = 1.0 + 0.01 * static_cast<double>(i);
    const auto found = reduce::distribution_of(values, {0.5, 2.0, 1.235});
    REQUIRE(found.size() == 10);
    const reduce::Estimate &all = found[7], &none = found[8], &some = found[9];
    // Wilson: z^2 = 3.8415; 32/(32 + z^2) and z^2/(32 + z^2).
    CHECK(all.value == 1.0);
    CHECK(all.low == Approx(0.89282).epsilon(1e-4));
    CHECK(all.high == 1.0);
    CHECK(none.value == 0.0);
    CHECK(none.low == 0.0);
    CHECK(none.high == Approx(0.10718).epsilon(1e-4));
    // 8 of 32: (8 + z^2/2 -+ z sqrt(8 24/32 + z^2/4))/(32 + z^2).
    CHECK(some.value == 0.25);
    CHECK(some.low == Approx(0.13252).epsilon(1e-4));
    CHECK(some.high == Approx(0.42107).epsilon(1e-4));
}

TEST_CASE("a sample without valid readings states why", "[reduce][sensitivity]") {
    ModelRun run("sobol-indices", 16, 3, test::ishigami);
    run.table.notes = {"not valid: domain.extent_mm: waves return", "warning: load: weak",
                       "not valid: solver.engine: not converged", "out of memory"};
    run.table.columns.insert(run.table.columns.end(), {"valid", "status", "note"});
    for (auto& row : run.table.rows)
        row.insert(row.end(), {std::string("no"), std::string("complete"), std::string("1")});
    run.table.rows[0].back() = std::string("1, 2, 3");
    const auto notes = [&](double scale) {
        const auto tables = reduce::uncertain_tables(run.plan, run.table, {"eta"});
        return std::pair{ModelRun::line(tables.statistics, scale, {"eta", "mean"}).note,
                         ModelRun::line(tables.sensitivity, scale, {"eta", "x1", "total"}).note};
    };
    // Two independent cases per sample for the statistics, and five in all for three keys.
    CHECK(notes(1.0).first ==
          "all 32 samples are invalid (domain.extent_mm: 32, solver.engine: 1)");
    CHECK(notes(10.0).second == "all 80 samples are invalid (domain.extent_mm: 80)");
    // One of the first two cases has failed.
    const std::size_t at = run.table.columns.size() - 3;
    run.table.rows[0][at] = std::string();
    run.table.rows[0][at + 1] = std::string("failed");
    run.table.rows[0][2] = std::nan("");
    run.table.rows[0][at + 2] = std::string("4");
    CHECK(notes(1.0).first == "none of 32 samples has a value (domain.extent_mm: 31, failed: 1)");
    // One that is valid: too few.
    run.table.rows[1][at] = std::string("yes");
    CHECK(notes(1.0).first == "too few samples: 1 value; at least 30 are required");
    CHECK(notes(1.0).second == "too few samples: none of them has a value in all of its 5 cases");
}

TEST_CASE("Morris measures separate linear, inactive and interacting keys",
          "[reduce][sensitivity]") {
    const ModelRun run("morris", 64, 4, [](const std::vector<double>& u) {
        return 3.0 * u[0] - u[1] + 5.0 * (u[2] - 0.5) * (u[2] - 0.5);
    });
    const auto measure = [&](const std::string& key, const std::string& index) {
        return ModelRun::line(run.evaluated.sensitivity, 1.0, {"eta", key, index});
    };
    CHECK(measure("x1", "mu").value == Approx(3.0));
    CHECK(measure("x1", "sigma").value == Approx(0.0).margin(1e-6)); // linear
    CHECK(measure("x2", "mu").value == Approx(-1.0));
    CHECK(measure("x2", "mu_star").value == Approx(1.0));
    CHECK(measure("x4", "mu_star").value == Approx(0.0).margin(1e-12)); // has no effect
    CHECK(measure("x3", "sigma").value > 1.0);                          // not linear
    // Effects of 5 (u - 1/2)^2 are 5 (a + b - 1) with independent a and b: their mean magnitude is
    // 5 / 3; 64 effects determine it within 20 %.
    CHECK(measure("x3", "mu_star").value == Approx(5.0 / 3.0).epsilon(0.2));
}

TEST_CASE("quantiles and probabilities of a sample have intervals that contain the exact values",
          "[reduce][sensitivity]") {
    const ModelRun run(
        "distribution", 1024, 1, [](const std::vector<double>& u) { return u[0] - 0.3; }, 24);
    const auto statistic = [&](const std::string& name) {
        return ModelRun::line(run.evaluated.statistics, 1.0, {"eta", name});
    };
    for (const auto& [name, exact] : {std::pair{"q05", -0.25},
                                      {"q25", -0.05},
                                      {"q50", 0.2},
                                      {"q75", 0.45},
                                      {"q95", 0.65},
                                      {"exceeds 0", 0.7}}) {
        const auto line = statistic(name);
        INFO(name << " " << line.value << " " << line.low << " " << line.high);
        CHECK(line.value == Approx(exact).margin(0.02)); // 24 of 1024 values are missing
        CHECK((line.low < exact && exact < line.high));
        CHECK(line.samples == 1000.0);
        CHECK(line.without == 24.0);
    }
    CHECK(run.evaluated.sensitivity.rows.empty());
    const ModelRun few("distribution", 20, 1, [](const std::vector<double>& u) { return u[0]; });
    CHECK(ModelRun::line(few.evaluated.statistics, 1.0, {"eta", "mean"}).note.find("too few") == 0);
}

TEST_CASE("a threshold of an unknown column is rejected with a suggestion",
          "[reduce][sensitivity]") {
    ModelRun run("distribution", 4, 1, [](const std::vector<double>& u) { return u[0]; });
    run.plan.uncertain->exceedance = {{"etta", 1.0}};
    CHECK_THROWS_WITH(reduce::uncertain_tables(run.plan, run.table, {}),
                      Catch::Contains("did you mean \"eta\"?"));
}

} // namespace test_sensitivity
