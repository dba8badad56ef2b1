// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/derived_tables.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <functional>

namespace test_adaptive_tables {

using namespace shearwake;
using Goal = AdaptiveAxis::Goal;

using Surface = std::function<double(double x, double y)>;

/// A plan with axes "x" and "y" on a grid, each case with a reference of the value `reference`.
struct Grid {
    Grid(const std::vector<AdaptiveAxis>& axes, const std::vector<double>& xs,
         const std::vector<double>& ys, const Surface& field, double reference = 0.0) {
        plan.swept_keys = {"x", "y"};
        plan.adaptive = axes;
        table.columns = {"id", "reference", "x", "y", "eta", "valid"};
        for (const double x : xs)
            for (const double y : ys) {
                const std::string id = std::to_string(plan.cases.size());
                plan.cases.push_back(
                    {.id = id, .settings = {{"x", x}, {"y", y}}, .reference_id = "r"});
                table.rows.push_back({id, std::string(), x, y, field(x, y), std::string("yes")});
            }
        plan.cases.push_back({.id = "r", .is_reference = true});
        table.rows.push_back({std::string("r"), std::string("yes"), std::nan(""), std::nan(""),
                              reference, std::string("yes")});
    }

    reduce::AdaptiveStates states() const { return reduce::adaptive_states(plan, table); }

    storage::PlanIndex plan;
    reduce::Table table;
};

static AdaptiveAxis axis(const std::string& key, Goal goal, double tolerance) {
    return {.key = key,
            .goal = goal,
            .first = 0.0,
            .last = 4.0,
            .column = "eta",
            .tolerance = tolerance,
            .smallest_step = 0.01};
}

const std::vector<double> five = {0.0, 1.0, 2.0, 3.0, 4.0};

static double number(const reduce::Table& table, std::size_t row, const std::string& column) {
    for (std::size_t i = 0; i < table.columns.size(); ++i)
        if (table.columns[i] == column) return std::get<double>(table.rows[row][i]);
    FAIL("no column " << column);
    return 0.0;
}

TEST_CASE("an interval is divided if any curve of the other axes requires it", "[reduce][adapt]") {
    const Grid grid({axis("x", Goal::refine, 1.2)}, five, {0.0, 1.0},
                    [](double x, double y) { return y * x * x; });
    const reduce::AdaptiveStates states = grid.states();
    REQUIRE(states.axes.size() == 1);
    CHECK(states.axes[0].next.empty()); // the estimate for x^2 is 1
    CHECK(states.table.rows.size() == 8);
    CHECK(number(states.table, 7, "estimated_error") == Approx(1.0));
    CHECK(number(states.table, 0, "estimated_error") == 0.0);
    const Grid steep({axis("x", Goal::refine, 1.2)}, five, {0.0, 2.0},
                     [](double x, double y) { return y * x * x; });
    CHECK(steep.states().axes[0].next.size() == 4);
}

TEST_CASE("axes that search the same extremum follow the best curve only", "[reduce][adapt]") {
    const Surface hill = [](double x, double y) {
        return -std::pow(x - 3.0, 2) - std::pow(y - 1.0, 2) + 0.4 * x * y;
    };
    const Grid grid({axis("x", Goal::maximum, 0.1), axis("y", Goal::maximum, 0.1)}, five, five,
                    hill);
    const reduce::AdaptiveStates states = grid.states();
    REQUIRE(states.axes.size() == 2);
    CHECK(states.axes[0].next == std::vector<double>{2.5, 3.5}); // the best point is (3, 2)
    CHECK(states.axes[1].next == std::vector<double>{1.5, 2.5});
    REQUIRE(states.table.rows.size() == 2);
    CHECK(number(states.table, 0, "value") == hill(3.0, 2.0));
    const Grid lines({axis("x", Goal::maximum, 0.1)}, five, {0.0, 4.0}, hill);
    CHECK(lines.states().table.rows.size() == 2); // one per value of y
}

TEST_CASE("two refined axes keep bilinear interpolation within both tolerances",
          "[reduce][adapt]") {
    const Surface ridge = [](double x, double y) {
        return std::exp(-std::pow(x - 0.5 * y - 1.0, 2)) + 0.02 * y * y;
    };
    std::vector<double> x = five, y = five;
    const auto add = [](std::vector<double>& to, const std::vector<double>& more) {
        to.insert(to.end(), more.begin(), more.end());
        std::ranges::sort(to);
    };
    const double tolerance = 0.01;
    for (bool grows = true; grows;) {
        const Grid grid({axis("x", Goal::refine, tolerance), axis("y", Goal::refine, tolerance)}, x,
                        y, ridge);
        const reduce::AdaptiveStates states = grid.states();
        add(x, states.axes[0].next);
        add(y, states.axes[1].next);
        grows = !states.axes[0].next.empty() || !states.axes[1].next.empty();
        REQUIRE(x.size() * y.size() < 3000);
    }
    const auto place = [](const std::vector<double>& points, double at) {
        const auto above = std::ranges::upper_bound(points, at) - points.begin();
        return static_cast<std::size_t>(
            std::clamp<std::ptrdiff_t>(above, 1, std::ssize(points) - 1));
    };
    double worst = 0.0;
    for (double at_x = 0.0; at_x <= 4.0; at_x += 0.0371)
        for (double at_y = 0.0; at_y <= 4.0; at_y += 0.0413) {
            const std::size_t i = place(x, at_x), j = place(y, at_y);
            const double s = (at_x - x[i - 1]) / (x[i] - x[i - 1]);
            const auto along = [&](double fixed) {
                return std::lerp(ridge(x[i - 1], fixed), ridge(x[i], fixed), s);
            };
            const double found =
                std::lerp(along(y[j - 1]), along(y[j]), (at_y - y[j - 1]) / (y[j] - y[j - 1]));
            worst = std::max(worst, std::abs(found - ridge(at_x, at_y)));
        }
    CHECK(worst < 2.0 * tolerance); // the sum of the errors of both axes
    CHECK(worst > 0.1 * tolerance);
    CHECK(x.size() > five.size());
}

TEST_CASE("crossings are those with the level or with the reference", "[reduce][adapt]") {
    const Surface line = [](double x, double) { return x; };
    AdaptiveAxis level = axis("x", Goal::crossing, 2.0);
    const Grid reference({level}, five, {0.0}, line, 2.25);
    REQUIRE(reference.states().table.rows.size() == 1);
    CHECK(number(reference.states().table, 0, "location") == Approx(2.25));
    CHECK(reference.states().axes[0].next.empty()); // the interval of 1 is within the tolerance
    level.has_level = true;
    level.level = 0.5;
    const Grid given({level}, five, {0.0}, line, 2.25);
    CHECK(number(given.states().table, 0, "location") == Approx(0.5));
    level.level = 9.0;
    const reduce::AdaptiveStates none = Grid({level}, five, {0.0}, line).states();
    CHECK(none.table.rows.empty());
    CHECK(none.axes[0].sentences.front().find("no crossing of eta") != std::string::npos);
}

TEST_CASE("readings that are not valid are no extrema", "[reduce][adapt]") {
    Grid grid({axis("x", Goal::maximum, 0.1)}, five, {0.0}, [](double x, double) { return x; });
    CHECK(number(grid.states().table, 0, "location") == 4.0); // the last point
    grid.table.rows[4].back() = std::string("no");
    const reduce::AdaptiveStates states = grid.states();
    CHECK(number(states.table, 0, "location") == 3.0);
}

TEST_CASE("a ratio is not valid if the readings of the reference are not", "[reduce]") {
    const std::string ratio = "eta_period_over_reference_1";
    Grid grid(
        {}, {1.0}, {0.0}, [](double, double) { return 0.4; }, 0.2);
    grid.table.columns[4] = ratio;
    CHECK(reduce::valid_value(grid.plan, grid.table, 0, ratio) == 0.4);
    grid.table.rows[1].back() = std::string("no");
    CHECK(std::isnan(reduce::valid_value(grid.plan, grid.table, 0, ratio)));
    grid.table.columns[4] = "eta_period_1";
    CHECK(reduce::valid_value(grid.plan, grid.table, 0, "eta_period_1") == 0.4);
}

} // namespace test_adaptive_tables
