// SPDX-License-Identifier: BSD-3-Clause
#include "base/json.hpp"

#include <catch2/catch.hpp>
#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

namespace test_json {

using namespace shearwake;
using Library = nlohmann::ordered_json;

constexpr double infinite = std::numeric_limits<double>::infinity();

TEST_CASE("JSON is read as it was composed, on one line") {
    const std::string text = "\"quoted\" \\ \n \x01 \xc2\xb5m";
    const std::vector<std::string> words{"a", "\"b\""};
    const std::string line = Json({{"text", text},
                                   {"member \"of\" a name", "v"},
                                   {"count", 7},
                                   {"size", std::size_t{1} << 60},
                                   {"is_new", true},
                                   {"value", 0.1},
                                   {"whole", 3.0},
                                   {"words", words},
                                   {"inner", Json::object()}})
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
    CHECK(Json(infinite).text() == "null");
    CHECK(Json(std::numeric_limits<double>::quiet_NaN()).text() == "null");
    CHECK(Json("a\xff").text() == "\"a\xef\xbf\xbd\"");
    CHECK(Json({{"a\xff", 1}}).text() == "{\"a\xef\xbf\xbd\":1}");
    CHECK(Json::array().text() == "[]");
    CHECK_THROWS(Json("a\xff").dump());
}

/// The same document as a value of either class.
template <class Value>
Value varied() {
    Value document = {{"z", nullptr},
                      {"a", {1, -2, 2.5, 1e300, -0.0, 1.0, 1e-7, 0.1 + 0.2, 5e-324, 123456789.0}},
                      {"pairs", {{"x", 1}, {"y", {{"deep", Value::array()}}}}},
                      {"lists", {{1, 2}, {"x", "y", "z"}}},
                      {"words", {"schema", "job"}},
                      {"one", {"word"}},
                      {"limits",
                       {std::numeric_limits<std::int64_t>::min(),
                        std::numeric_limits<std::uint64_t>::max(), infinite}},
                      {"text", "\t\b\f\r\n\x1f\x7f/\\\" \xc3\xa9 \xf0\x9f\x98\x80"},
                      {"empty", Value::object()},
                      {"list", Value::array({Value::array({"k", 1})})}};
    document["new"]["of"]["null"].push_back({{"required", {"a"}}});
    document["a"] = document["words"];
    document["words"].push_back(false);
    document.update({{"z", 1.5}, {"last", std::vector<double>{1.0, 2.5}}});
    document.erase("one");
    return document;
}

TEST_CASE("the text of JSON is that of nlohmann-json") {
    const auto library = varied<Library>();
    const auto own = varied<Json>();
    for (const int indent : {-1, 0, 1, 2})
        CHECK(own.dump(indent) == library.dump(indent));
    CHECK(Json::parse(library.dump(1)).dump(1) == Library::parse(library.dump(1)).dump(1));
    for (const char* text :
         {"[1,[ 2 , {} ],\"\\u00e9\\ud83d\\ude00\",1E2,-0,-0.0,18446744073709551615]",
          "{\"b\":1,\"a\":2,\"b\":{\"c\":3},\"a\":[]}", "18446744073709551616", " null ", "\"\""})
        CHECK(Json::parse(text).dump() == Library::parse(text).dump());
}

TEST_CASE("text that is not one JSON value is refused with the place") {
    for (const char* text : {"", "{\"a\":1", "[1,]", "nul", "{}x", "{1:2}", "\"a\xff\"", "1e999"}) {
        CAPTURE(text);
        CHECK_THROWS_AS(Json::parse(text), JsonError);
        CHECK(Json::parse_or_null(text).is_null());
    }
    CHECK_THROWS_WITH(Json::parse("{\n\"a\" 1}"), Catch::Contains("line 2, column 5"));
}

TEST_CASE("the nesting of JSON is limited") {
    const auto nested = [](std::size_t levels) {
        return std::string(levels, '[') + std::string(levels, ']');
    };
    CHECK(Json::parse(nested(200)).dump() == nested(200));
    CHECK_THROWS_AS(Json::parse(nested(202)), JsonError);
    CHECK_THROWS_AS(Json::parse(nested(1000000)), JsonError);
    CHECK_THROWS_AS(Json::parse(std::string(1000000, '[')), JsonError);
    CHECK(Json::parse_or_null("{\"a\":[1,[2,{\"b\":3}],4],\"c\":{\"d\":[5]},\"e\":6}", 2).dump() ==
          "{\"a\":[1,[],4],\"c\":{\"d\":[]},\"e\":6}");
}

TEST_CASE("integers of JSON keep 64 bits") {
    const Json read = Json::parse("[-9223372036854775808, 9223372036854775807, "
                                  "18446744073709551615, 1.0]");
    CHECK(read.at(0).get<std::int64_t>() == std::numeric_limits<std::int64_t>::min());
    CHECK(read.at(1).get<std::int64_t>() == std::numeric_limits<std::int64_t>::max());
    CHECK(read.at(2).get<std::uint64_t>() == std::numeric_limits<std::uint64_t>::max());
    CHECK(read.at(2).is_integer());
    CHECK(read.at(3).is_float());
    CHECK((read.at(3) == 1)); // Catch would print a number as a list
    CHECK((Json(1) == 1U));
    CHECK((Json(1) != true));
}

TEST_CASE("a value of another type than expected is refused") {
    Json value = Json::parse("{\"text\": \"a\", \"list\": [1], \"none\": null}");
    CHECK_THROWS_AS(value.at("text").get<double>(), JsonError);
    CHECK_THROWS_AS(value.at("none").get<bool>(), JsonError);
    CHECK_THROWS_AS(value.at("list").get<std::vector<std::string>>(), JsonError);
    CHECK_THROWS_AS(value.at("list").at("a"), JsonError);
    CHECK_THROWS_AS(value.at("list").at(1), JsonError);
    CHECK_THROWS_AS(value.at("list")["a"], JsonError);
    CHECK_THROWS_AS(value.at("text").push_back(1), JsonError);
    CHECK_THROWS_AS(value.at("other"), JsonError);
    CHECK_THROWS_AS(value.at("none").begin(), JsonError);
    CHECK_THROWS_AS(value.items().at(0).value.items(), JsonError);
    CHECK(value.at("text").find("a") == nullptr);
    CHECK(value.value("text", std::string("b")) == "a");
    CHECK(value.value("other", 2) == 2);
}

} // namespace test_json
