// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/reduce.hpp"

#include "base/json.hpp"
#include "storage/case_file/case_file_writer.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "storage/journal/plan_file.hpp"
#include "support/cases.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <limits>

namespace test_reduce {

using namespace shearwake;

TEST_CASE("special characters in cells are quoted in CSV and Markdown", "[reduce]") {
    const reduce::Table table{{"a", "b,c"},
                              {{1.0 / 3.0, std::string("say \"x|y\",\nthen z")},
                               {std::numeric_limits<double>::quiet_NaN(), std::string()}}};
    CHECK(reduce::csv(table) == "a,\"b,c\"\n0.333333333,\"say \"\"x|y\"\",\nthen z\"\n,\n");
    CHECK(reduce::markdown(table, {"b,c", "a", "none"}) ==
          "| b,c | a |\n| --- | --- |\n| say \"x\\|y\", then z | 0.3333 |\n|  |  |\n");
}

TEST_CASE("each remark stands once below a Markdown table", "[reduce]") {
    const reduce::Table table{{"id", "note"},
                              {{std::string("a"), std::string("1, 2")},
                               {std::string("b"), std::string()},
                               {std::string("c"), std::string("2")}},
                              {"waves return", "no <period>"}};
    CHECK(reduce::markdown(table, {"id", "note"}) ==
          "| id | note |\n| --- | --- |\n| a | 1, 2 |\n| b |  |\n| c | 2 |\n"
          "\n1. waves return\n2. no &lt;period>\n");
    CHECK(reduce::csv(table) == "id,note\na,\"1, 2\"\nb,\nc,2\n");
    CHECK(reduce::markdown(table, {"id"}) == "| id |\n| --- |\n| a |\n| b |\n| c |\n");
}

TEST_CASE("the first rows of a table stand below the labels of its columns", "[reduce]") {
    const reduce::Table table{{"eta_period_over_reference_1", "peak_um"},
                              {{1.0625, 1.5}, {2.0, 10.25}, {4.0, 3.0}}};
    CHECK(reduce::first_rows(table, {"eta_period_over_reference_1", "none", "peak_um"}, 2) ==
          "   efficiency η\n"
          "relative to the            largest\n"
          "      reference  displacement (µm)\n"
          "          1.062                1.5\n"
          "              2              10.25\n");
}

TEST_CASE("every case is a row with its status", "[reduce]") {
    const char *good = "a", *failed = "b", *damaged = "c", *reference = "d"; // ids are hexadecimal
    const test::TemporaryFolder folder;
    const Comm alone = Comm::world().split(Comm::world().rank());
    const Case c = test::moving_focus(test::half_space(test::tissue()), ConstantSpeed{7.0});
    Plan plan{.name = "job", .title = "title", .swept_keys = {"load.peak_Pa"}};
    for (const char* id : {good, failed, damaged, "e", reference})
        plan.cases.push_back({id, c, {{"load.peak_Pa", 5.0}}, false, reference});
    plan.cases.back().is_reference = true;
    plan.cases.back().reference_id.clear();
    storage::write_file(folder / "plan.json", storage::plan_text(plan));
    storage::make_directory(folder / "cases");
    const auto write = [&](const std::string& id, double eta, double rms, const std::string& note) {
        storage::CaseFileWriter(folder / ("cases/" + id + ".h5"), alone, {})
            .commit({{"",
                      {{"eta_period_1", {}, {eta}, "1", "eta", ""},
                       {"focal_rms_um", {}, {rms}, "um", "rms", note},
                       {"felt_peak_dB", {}, {12.0}, "dB", "level", "from a window"}}}},
                    {{"title", std::string("t")},
                     {"case_id", id},
                     {"wall_s", 0.25},
                     {"status", std::string("complete")}});
    };
    write(good, 0.2, std::numeric_limits<double>::quiet_NaN(), "no disc");
    write(reference, 0.1, 2.0, "");
    storage::write_file(folder / "cases" / (damaged + std::string(".h5")), "no HDF5");
    storage::Journal(folder / "journal.jsonl")
        .failed(failed, "out of memory", storage::Cause::case_itself);

    const reduce::ReduceInput input{folder / "", folder / "plan.json", folder / "tables"};
    const reduce::Table table = reduce::table_of(input);
    const auto cell = [&](std::size_t row, const std::string& column) {
        const auto found = std::find(table.columns.begin(), table.columns.end(), column);
        REQUIRE(found != table.columns.end());
        return table.rows.at(row).at(static_cast<std::size_t>(found - table.columns.begin()));
    };
    REQUIRE(table.rows.size() == 5);
    CHECK(std::get<double>(cell(0, "eta_period_1")) == 0.2);
    CHECK(std::get<double>(cell(0, "eta_period_over_reference_1")) == 2.0);
    CHECK(std::isnan(std::get<double>(cell(0, "focal_rms_um"))));
    CHECK(std::get<std::string>(cell(0, "note")) == "1, 2");
    CHECK(table.note(0) ==
          std::vector<std::string>{"focal rms: no disc", "peak level of sensation: from a window"});
    CHECK(std::get<double>(cell(0, "wall_s")) == 0.25);
    CHECK(std::get<std::string>(cell(1, "status")) == "failed");
    CHECK(table.note(1) == std::vector<std::string>{"out of memory"});
    CHECK(std::get<std::string>(cell(2, "status")) == "damaged");
    CHECK(std::get<std::string>(cell(3, "status")) == "missing");
    CHECK(std::get<std::string>(cell(4, "reference")) == "yes");
    const reduce::ReducedTables written = reduce::reduce(input);
    CHECK(written.rows == 5);
    CHECK(written.complete == 2);
    CHECK(storage::read_file(written.csv) == reduce::csv(table));
    const auto json = Json::parse(storage::read_file(folder / "tables/job.json"));
    CHECK(json.at("cases").at(0).at("notes").size() == 2);
    CHECK(json.at("cases").at(1).at("notes").empty());
}

} // namespace test_reduce
