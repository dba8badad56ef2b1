// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/table.hpp"

#include "base/error.hpp"

#include <catch2/catch.hpp>
#include <limits>

namespace test_read_csv {

using namespace shearwake;

TEST_CASE("a written table is read back cell by cell", "[csv]") {
    const reduce::Table table{{"a", "b,c"},
                              {{0.25, std::string("say \"x\",\r\nthen y")},
                               {std::numeric_limits<double>::quiet_NaN(), std::string()}}};
    const reduce::TextTable read = reduce::read_csv(reduce::csv(table), "t.csv");
    CHECK(read.columns == table.columns);
    REQUIRE(read.rows.size() == 2);
    CHECK(read.rows[0] == std::vector<std::string>{"0.25", "say \"x\",\r\nthen y"});
    CHECK(read.rows[1] == std::vector<std::string>{"", ""});
    CHECK(read.find("b,c") == 1);
    CHECK_FALSE(read.find("c"));
}

TEST_CASE("tables of spreadsheets are read, with byte order mark, CRLF and no final line end",
          "[csv]") {
    const reduce::TextTable read = reduce::read_csv("\xef\xbb\xbfid,x\r\na,1\r\nb,2", "t.csv");
    CHECK(read.columns == std::vector<std::string>{"id", "x"});
    REQUIRE(read.rows.size() == 2);
    CHECK(read.rows[1] == std::vector<std::string>{"b", "2"});
    for (const char* text :
         {"id;x\r\na;1\r\nb;2\r\n", "id\tx\na\t1\nb\t2\n", "id,x,,\na,1,,\nb,2\n"}) {
        CAPTURE(text);
        const reduce::TextTable other = reduce::read_csv(text, "t.csv");
        CHECK(other.columns == read.columns);
        CHECK(other.rows == read.rows);
    }
}

TEST_CASE("an invalid table is rejected with the line and the reason", "[csv]") {
    const auto [text, line, reason] = GENERATE(table<const char*, const char*, const char*>(
        {{"", "t.csv:1:", "empty"},
         {"a,b\n1\n", "t.csv:2:", "1 cells for 2 columns"},
         {"a,b\n\"1\n2\",3\n1,2,3\n", "t.csv:4:", "3 cells, but the first row has 2"},
         {"id;x\na;1,5\n", "t.csv:2:", "the number \"1,5\" with a decimal comma"},
         {"a\n\"1\n", "t.csv:2:", "never closed"},
         {"a\n\"1\"2\n", "t.csv:2:", "after its closing quote"},
         {"a,b,a\n", "t.csv:1:", "two columns are named \"a\""}}));
    CAPTURE(text);
    try {
        reduce::read_csv(text, "t.csv");
        FAIL("it was taken for a table");
    } catch (const UsageError& error) {
        CHECK(error.code() == ExitCode::environment);
        CHECK_THAT(error.what(), Catch::Contains(line) && Catch::Contains(reason));
    }
}

} // namespace test_read_csv
