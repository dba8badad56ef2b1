#include "reduce/read_csv.hpp"

#include "base/error.hpp"
#include "reduce/table.hpp"

#include <catch2/catch.hpp>
#include <limits>

using namespace shearwake;

TEST_CASE("what the table writer writes is read back cell by cell", "[csv]") {
    const Table table{{"a", "b,c"},
                      {{0.25, std::string("say \"x\",\r\nthen y")},
                       {std::numeric_limits<double>::quiet_NaN(), std::string()}}};
    const TextTable read = read_csv(csv(table), "t.csv");
    CHECK(read.columns == table.columns);
    REQUIRE(read.rows.size() == 2);
    CHECK(read.rows[0] == std::vector<std::string>{"0.25", "say \"x\",\r\nthen y"});
    CHECK(read.rows[1] == std::vector<std::string>{"", ""});
    CHECK(read.find("b,c") == 1);
    CHECK_FALSE(read.find("c"));
}

TEST_CASE("the tables of spreadsheets are read: byte order mark, CRLF, no last line end", "[csv]") {
    const TextTable read = read_csv("\xef\xbb\xbfid,x\r\na,1\r\nb,2", "t.csv");
    CHECK(read.columns == std::vector<std::string>{"id", "x"});
    REQUIRE(read.rows.size() == 2);
    CHECK(read.rows[1] == std::vector<std::string>{"b", "2"});
}

TEST_CASE("what is no table is refused with the line and the reason", "[csv]") {
    const auto [text, line, reason] = GENERATE(table<const char*, const char*, const char*>(
        {{"", "t.csv:1:", "empty"},
         {"a,b\n1\n", "t.csv:2:", "1 cells under 2 columns"},
         {"a,b\n\"1\n2\",3\n1,2,3\n", "t.csv:4:", "3 cells under 2 columns"},
         {"a\n\"1\n", "t.csv:2:", "never closed"},
         {"a\n\"1\"2\n", "t.csv:2:", "behind its closing quote"},
         {"a,b,a\n", "t.csv:1:", "two columns are called \"a\""}}));
    CAPTURE(text);
    try {
        read_csv(text, "t.csv");
        FAIL("it was taken for a table");
    } catch (const UsageError& error) {
        CHECK(error.code() == ExitCode::environment);
        CHECK_THAT(error.what(), Catch::Contains(line) && Catch::Contains(reason));
    }
}
