// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "support/cases.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>

namespace test_plan_and_journal {

using namespace shearwake;

static Plan small_plan() {
    const Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    Plan plan{.name = "a", .title = "\"quoted\" \xc3\xbc", .swept_keys = {"load.peak_Pa", "kind"}};
    plan.table = {.x = "load.peak_Pa", .series = {"kind"}};
    plan.cases.push_back(
        {"01", c, {{"load.peak_Pa", 0.1}, {"kind", std::string("STM")}}, false, "02"});
    plan.cases.push_back({"02", c, {}, true, ""});
    return plan;
}

TEST_CASE("a plan reads back as it was written", "[plan]") {
    const test::TemporaryFolder folder;
    const Plan plan = small_plan();
    storage::write_file(folder / "plan.json", storage::plan_text(plan));
    CHECK(storage::plan_text(plan) == storage::plan_text(small_plan()));
    const storage::PlanIndex index = storage::read_plan(folder / "plan.json");
    CHECK(index.name == plan.name);
    CHECK(index.title == plan.title);
    CHECK(index.swept_keys == plan.swept_keys);
    CHECK(index.table == plan.table);
    REQUIRE(index.cases.size() == 2);
    CHECK(index.cases[0].settings == plan.cases[0].settings);
    CHECK(index.cases[0].reference_id == "02");
    CHECK(index.cases[1].is_reference);
}

TEST_CASE("a plan is extended by points of the same adaptive axes only", "[plan]") {
    using storage::PlanMatch;
    Plan plan = small_plan();
    plan.adaptive = {{.key = "load.peak_Pa",
                      .goal = AdaptiveAxis::Goal::crossing,
                      .first = 0.1,
                      .last = 1.0,
                      .column = "eta_period_1",
                      .tolerance = 0.01,
                      .has_level = true,
                      .level = 0.3}};
    const std::string text = storage::plan_text(plan);
    const test::TemporaryFolder folder;
    storage::write_file(folder / "plan.json", text);
    CHECK(storage::read_plan(folder / "plan.json").adaptive == plan.adaptive);
    CHECK(storage::compare_plan(text, plan) == PlanMatch::same);
    Plan larger = plan;
    larger.cases.insert(larger.cases.begin(), {"03", plan.cases[0].physics, {}, false, "02"});
    CHECK(storage::compare_plan(text, larger) == PlanMatch::extended);
    CHECK(storage::compare_plan(storage::plan_text(larger), plan) == PlanMatch::another);
    larger.adaptive[0].tolerance = 0.001;
    CHECK(storage::compare_plan(text, larger) == PlanMatch::extended);
    larger.adaptive[0].level = 0.4;
    CHECK(storage::compare_plan(text, larger) == PlanMatch::another);
    larger.adaptive.clear(); // an ordinary sweep with more values is another plan
    CHECK(storage::compare_plan(text, larger) == PlanMatch::another);
    Plan smaller = small_plan();
    CHECK(storage::compare_plan(storage::plan_text(smaller), larger) == PlanMatch::another);
}

TEST_CASE("an invalid plan is rejected", "[plan]") {
    const test::TemporaryFolder folder;
    for (const char* text : {"", "{", "[]", "{\"name\": 3}", "{\"name\": \"a\"}"}) {
        storage::write_file(folder / "plan.json", text);
        CHECK_THROWS_AS(storage::read_plan(folder / "plan.json"), UsageError);
    }
}

TEST_CASE("a plan whose names lead outside its folder is rejected", "[plan]") {
    const test::TemporaryFolder folder;
    for (const std::string name : {"../../escaped", "/tmp/x", "", ".hidden", "a b", "a/b"}) {
        Plan plan = small_plan(), of_cases = small_plan();
        plan.name = name;
        of_cases.cases[0].id = name;
        for (const Plan& hostile : {plan, of_cases}) {
            storage::write_file(folder / "plan.json", storage::plan_text(hostile));
            CHECK_THROWS_AS(storage::read_plan(folder / "plan.json"), UsageError);
        }
    }
}

TEST_CASE("the journal gives the latest state of each case and ignores a truncated line",
          "[journal]") {
    const test::TemporaryFolder folder;
    const storage::Journal journal(folder / "journal.jsonl");
    CHECK(storage::read_journal(folder / "journal.jsonl").cases.empty());
    journal.run_started({.run = "here-1", .ranks = 2, .cases_left = 3, .overrides = {"a=1"}});
    CHECK(storage::read_journal(folder / "journal.jsonl").runs.contains("here-1"));
    CHECK(storage::read_journals(folder / "").overrides == std::vector<std::string>{"a=1"});
    journal.started("a", 2);
    journal.finished("a", 0.5, "layered");
    journal.started("b", 2);
    journal.failed("b", "a reason with \"quotes\",\na line break and \xff", storage::Cause::files);
    journal.resumed("b", 20); // does not change the state of a case that has failed
    journal.started("c", 2);
    journal.checkpointed("c", 40);
    storage::append_line(folder / "journal.jsonl", "{\"event\": \"fini");
    storage::JournalContents contents = storage::read_journal(folder / "journal.jsonl");
    CHECK(contents.cases.at("a").state == storage::CaseHistory::State::finished);
    CHECK(contents.cases.at("b").cause == storage::Cause::files);
    CHECK(contents.cases.at("b").state == storage::CaseHistory::State::failed);
    CHECK(contents.cases.at("b").reason.find("line break") != std::string::npos);
    CHECK(contents.cases.at("c").state == storage::CaseHistory::State::started);
    journal.run_ended("done");
    contents = storage::read_journal(folder / "journal.jsonl");
    CHECK(contents.runs.empty());
}

} // namespace test_plan_and_journal
