#include "config/tree.hpp"

#include <catch2/catch.hpp>

using namespace shearwake;

namespace {

NodePtr parse(std::string_view text) {
    Diagnostics findings;
    const NodePtr tree = parse_toml(text, "t.toml", findings);
    REQUIRE(findings.errors() == 0);
    return tree;
}

NodePtr at(const NodePtr& root, std::string_view path) {
    return find(root, split_path(path).value());
}

} // namespace

TEST_CASE("a path is keys, quoted keys and places in lists", "[config][tree]") {
    const auto path = split_path("a.\"b.c\".d[2][1].e").value();
    REQUIRE(path.size() == 6);
    CHECK(path[1].key == "b.c");
    CHECK(path[3].index == 2);
    CHECK(path[4].index == 1);
    CHECK(path[5].key == "e");
}

TEST_CASE("what is no path is refused", "[config][tree]") {
    const std::string text =
        GENERATE("", ".", "a.", ".a", "a..b", "a[", "a[]", "a[0]", "a[x]", "a[1", "a[1]b", "[1]",
                 "\"a", "\"a\"b", "a[-1]", "a[99999999999999999999]");
    CHECK_FALSE(split_path(text));
}

TEST_CASE("keys keep the order and the places of the file", "[config][tree]") {
    const NodePtr root = parse("z = 1\na = [1,\n  2]\n[t]\n  b = 'x'\n");
    const auto& entries = std::get<TableNode>(root->value).entries;
    CHECK(entries[0].key == "z");
    CHECK(entries[1].key == "a");
    CHECK(at(root, "a[2]")->at.line == 3);
    CHECK(at(root, "a[2]")->at.column == 3);
    CHECK(place_of(root, *split_path("t.b")).column == 3);
    CHECK(at(root, "t.b")->at.column == 7);
    CHECK(place_of(root, *split_path("t.c")).line == 4); // its table
    CHECK(place_of(root, *split_path("u.c")).line == 0); // nowhere
}

TEST_CASE("a changed tree leaves the old one alone and shares the rest", "[config][tree]") {
    const NodePtr root = parse("[a]\nb = 1\nc = [{ d = 2 }]\n[e]\nf = 3\n");
    std::string problem;
    const NodePtr changed = with(root, *split_path("a.c[1].d"), make_node(7.0, {}), {}, problem);
    REQUIRE(changed);
    CHECK(std::get<double>(at(changed, "a.c[1].d")->value) == 7.0);
    CHECK(std::get<std::int64_t>(at(root, "a.c[1].d")->value) == 2);
    CHECK(at(changed, "e") == at(root, "e"));
    const NodePtr grown = with(root, *split_path("x.y.z"), make_node(true, {}), {}, problem);
    CHECK(std::get<bool>(at(grown, "x.y.z")->value));
    CHECK_FALSE(with(root, *split_path("a.b.c"), make_node(true, {}), {}, problem));
    CHECK(problem == "b is a number, not a table");
}

TEST_CASE("values are the same whatever their number's type", "[config][tree]") {
    const NodePtr root = parse("a = 2\nb = 2.0\nc = '2'\nd = [1, { x = 2 }]\ne = [1.0, { x = 2 }]");
    CHECK(same_value(*at(root, "a"), *at(root, "b")));
    CHECK_FALSE(same_value(*at(root, "a"), *at(root, "c")));
    CHECK(same_value(*at(root, "d"), *at(root, "e")));
    CHECK(render(*at(root, "d")) == "[1, { x = 2 }]");
}

TEST_CASE("an excerpt is short and printable", "[config][tree]") {
    CHECK(excerpt("abc") == "abc");
    CHECK(excerpt("a\n\x01\xff") == "a???");
    CHECK(excerpt(std::string(100, 'x'), 5) == "xxxxx...");
}

TEST_CASE("letters beyond ASCII stand in strings and comments alone", "[tree]") {
    const auto mistakes = [](const std::string& text) {
        Diagnostics findings;
        parse_toml(text, "job.toml", findings);
        return findings.errors();
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
}
