// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/tree.hpp"

#include <catch2/catch.hpp>

namespace test_tree {

using namespace shearwake;

static config::NodePtr parse(std::string_view text) {
    config::DiagnosticList diagnostics;
    const config::NodePtr tree = config::parse_toml(text, "t.toml", diagnostics);
    REQUIRE(diagnostics.errors() == 0);
    return tree;
}

static config::NodePtr at(const config::NodePtr& root, std::string_view path) {
    return config::find(root, config::split_path(path).value());
}

TEST_CASE("a path consists of keys, quoted keys and list indices", "[config][tree]") {
    const auto path = config::split_path("a.\"b.c\".d[2][1].e").value();
    REQUIRE(path.size() == 6);
    CHECK(path[1].key == "b.c");
    CHECK(path[3].index == 2);
    CHECK(path[4].index == 1);
    CHECK(path[5].key == "e");
}

TEST_CASE("an invalid path is rejected", "[config][tree]") {
    const std::string text =
        GENERATE("", ".", "a.", ".a", "a..b", "a[", "a[]", "a[0]", "a[x]", "a[1", "a[1]b", "[1]",
                 "\"a", "\"a\"b", "a[-1]", "a[99999999999999999999]");
    CHECK_FALSE(config::split_path(text));
}

TEST_CASE("keys keep their order and locations in the file", "[config][tree]") {
    const config::NodePtr root = parse("z = 1\na = [1,\n  2]\n[t]\n  b = 'x'\n");
    const auto& entries = std::get<config::TableNode>(root->value).entries;
    CHECK(entries[0].key == "z");
    CHECK(entries[1].key == "a");
    CHECK(at(root, "a[2]")->at.line == 3);
    CHECK(at(root, "a[2]")->at.column == 3);
    CHECK(config::place_of(root, *config::split_path("t.b")).column == 3);
    CHECK(at(root, "t.b")->at.column == 7);
    CHECK(config::place_of(root, *config::split_path("t.c")).line == 4); // its table
    CHECK(config::place_of(root, *config::split_path("u.c")).line == 0); // nowhere
}

TEST_CASE("a changed tree leaves the old one alone and shares the rest", "[config][tree]") {
    const config::NodePtr root = parse("[a]\nb = 1\nc = [{ d = 2 }]\n[e]\nf = 3\n");
    std::string problem;
    const config::NodePtr changed = config::with(root, *config::split_path("a.c[1].d"),
                                                 config::make_node(7.0, {}), {}, problem);
    REQUIRE(changed);
    CHECK(std::get<double>(at(changed, "a.c[1].d")->value) == 7.0);
    CHECK(std::get<std::int64_t>(at(root, "a.c[1].d")->value) == 2);
    CHECK(at(changed, "e") == at(root, "e"));
    const config::NodePtr grown =
        config::with(root, *config::split_path("x.y.z"), config::make_node(true, {}), {}, problem);
    CHECK(std::get<bool>(at(grown, "x.y.z")->value));
    CHECK_FALSE(
        config::with(root, *config::split_path("a.b.c"), config::make_node(true, {}), {}, problem));
    CHECK(problem == "b is a number, not a table");
}

TEST_CASE("values are compared independent of their number type", "[config][tree]") {
    const config::NodePtr root =
        parse("a = 2\nb = 2.0\nc = '2'\nd = [1, { x = 2 }]\ne = [1.0, { x = 2 }]");
    CHECK(config::same_value(*at(root, "a"), *at(root, "b")));
    CHECK_FALSE(config::same_value(*at(root, "a"), *at(root, "c")));
    CHECK(config::same_value(*at(root, "d"), *at(root, "e")));
    CHECK(config::render(*at(root, "d")) == "[1, { x = 2 }]");
}

TEST_CASE("an excerpt is short and printable", "[config][tree]") {
    CHECK(config::excerpt("abc") == "abc");
    CHECK(config::excerpt("a\n\x01\xff") == "a???");
    CHECK(config::excerpt(std::string(100, 'x'), 5) == "xxxxx...");
}

TEST_CASE("non-ASCII characters are allowed only in strings and comments", "[tree]") {
    const auto mistakes = [](const std::string& text) {
        config::DiagnosticList diagnostics;
        config::parse_toml(text, "job.toml", diagnostics);
        return diagnostics.errors();
    };
    CHECK(mistakes("a = \"\xc3\xa9 \\\" \xc3\xa9\" # \xc3\xa9\nb = '\xc3\xa9'\n") == 0);
    CHECK(mistakes("\xef\xbb\xbf"
                   "a = \"\"\"\n\xc3\xa9 \"\" \"\"\"\"\" # \xc3\xa9\n") == 0);
    // toml++ 3.3 asks for the impossible at the first and the last.
    for (const char* letter : {"\xef\xbb\xb8", "\xc3\xa9", "\xff", "\xe1\x9a\x80"})
        CHECK(mistakes("a = 1\n" + std::string(letter) + " = 2\n") == 1);
    // And here, where a quote that begins no string hides the letter from a first look.
    CHECK(mistakes("_m =16E2EEKEEEE'16E2EE\xc2\xba"
                   "EEE:E::EE\n") == 1);
    CHECK(mistakes("\"\xc3\xa9\" = [\"\xc3\xa9\",'\xc3\xa9', {a='\xc3\xa9'}]\n") == 0);
    for (const char* hidden : {"a = 1.'\xc2\xba'\n", "a = [\n1.'\xc2\xba']\n",
                               "a = 'b''\xc2\xba'\n", "a.'#'\xc2\xba = 1\n", "a = 'b\n\xc2\xba'\n"})
        CHECK(mistakes(hidden) == 1);
}

} // namespace test_tree
