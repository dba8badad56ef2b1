// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/case_index.hpp"

#include "storage/case_file/case_file_writer.hpp"
#include "storage/files.hpp"
#include "storage/journal/journal.hpp"
#include "support/temporary_folder.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <limits>

namespace test_case_index {

using namespace shearwake;

static storage::CaseDigest write_case(const std::filesystem::path& folder, const std::string& id,
                                      double value) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const std::vector<VariableGroup> groups = {
        {"",
         {{"a", {}, {value}, "1", "a", ""},
          {"b", {}, {std::numeric_limits<double>::quiet_NaN()}, "1", "b", "why not"}}}};
    const std::vector<Attribute> attributes = {{"title", std::string("t")},
                                               {"case_id", id},
                                               {"git_id", std::string("0abc")},
                                               {"wall_s", 0.25},
                                               {"status", std::string("complete")}};
    storage::CaseFileWriter(folder / "cases" / (id + ".h5"), alone, {}).commit(groups, attributes);
    return storage::digest_of(groups, attributes);
}

TEST_CASE("an index gives the content of the case files without opening them again", "[index]") {
    const test::TemporaryFolder folder;
    storage::make_directory(folder / "cases");
    write_case(folder / "", "1", 1.0 / 3.0);
    const storage::CaseDigest second = write_case(folder / "", "2", 2.0);
    storage::write_file(folder / "cases/3.h5", "no HDF5");
    storage::add_to_index(folder / "index.2-of-8.jsonl", folder / "cases/2.h5", second);
    storage::CaseIndex(folder / "").find("1");
    for (const bool saved : {false, true}) {
        storage::CaseIndex index(folder / "");
        REQUIRE(index.find("1"));
        CHECK(index.find("1")->scalars.at(0).value == 1.0 / 3.0);
        CHECK(std::isnan(index.find("1")->scalars.at(1).value));
        CHECK(index.find("1")->scalars.at(1).note == "why not");
        CHECK(index.find("1")->git_id == "0abc");
        CHECK(index.find("2")->scalars.at(0).value == 2.0);
        CHECK_FALSE(index.is_complete("3"));
        CHECK(index.find("3")->status == "damaged");
        CHECK(index.find("4") == nullptr);
        CHECK(std::filesystem::exists(folder / "index.jsonl") == saved);
        index.save();
    }
    // What has changed since is read again, and lines that are no JSON are passed over.
    storage::append_line(folder / "index.jsonl", "{\"id\": \"1\", \"size\"");
    write_case(folder / "", "1", 5.0);
    storage::CaseIndex index(folder / "");
    CHECK(index.find("1")->scalars.at(0).value == 5.0);
    CHECK(index.find("2")->scalars.at(0).value == 2.0);
}

TEST_CASE("journals of runs and hosts are combined, and the latest entry counts", "[journal]") {
    const test::TemporaryFolder folder;
    CHECK(storage::journal_name("node1-8", "node7") == "journal.node1-8@node7.jsonl");
    CHECK(storage::index_name(storage::journal_name("node1-8")) == "index.node1-8.jsonl");
    const storage::Journal first(folder / storage::journal_name("node1-8")),
        second(folder / storage::journal_name("node2-8"));
    first.run_started({.run = "node1-8", .teams = 2, .overrides = {"a=1"}});
    second.run_started({.run = "node2-8", .teams = 1});
    first.failed("x", "at first", storage::Cause::case_itself);
    second.failed("y", "for good", storage::Cause::files);
    second.finished("x", 1.0, "layered");
    const storage::JournalContents all = storage::read_journals(folder / "");
    CHECK(all.runs.at("node1-8") == 2);
    CHECK(all.runs.at("node2-8") == 1);
    CHECK(all.cases.at("x").state == storage::CaseHistory::State::finished);
    CHECK(all.cases.at("y").cause == storage::Cause::files);
    CHECK(storage::read_journals(folder / "none").cases.empty());
}

} // namespace test_case_index
