// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"

#include <catch2/catch.hpp>
#include <limits>
#include <nlohmann/json.hpp>

namespace test_json_line {

using namespace shearwake;

TEST_CASE("a line of JSON is read as it was composed") {
    const std::string text = "\"quoted\" \\ \n \x01 \xc2\xb5m";
    const std::vector<std::string> words{"a", "\"b\""};
    const std::string line = JsonLine()
                                 .add("text", text)
                                 .add("member \"of\" a name", "v")
                                 .add("count", 7)
                                 .add("size", std::size_t{1} << 60)
                                 .add("is_new", true)
                                 .add("value", 0.1)
                                 .add("whole", 3.0)
                                 .add("words", words)
                                 .add_json("inner", JsonLine().text())
                                 .text();
    CHECK(line.find('\n') == std::string::npos);
    const auto read = nlohmann::json::parse(line);
    CHECK(read.size() == 9);
    CHECK(read.at("text") == text);
    CHECK(read.at("member \"of\" a name") == "v");
    CHECK(read.at("count") == 7);
    CHECK(read.at("size") == std::size_t{1} << 60);
    CHECK(read.at("is_new") == true);
    CHECK(read.at("value") == 0.1);
    CHECK(read.at("whole").is_number_float());
    CHECK(read.at("words") == words);
    CHECK(read.at("inner").empty());
}

TEST_CASE("JSON has no infinity, and text that is not UTF-8 is replaced") {
    CHECK(json_number(std::numeric_limits<double>::infinity()) == "null");
    CHECK(json_number(std::numeric_limits<double>::quiet_NaN()) == "null");
    CHECK(json_string("a\xff") == "\"a\xef\xbf\xbd\"");
    CHECK(json_array({}) == "[]");
}

} // namespace test_json_line
