// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"

#include <catch2/catch.hpp>
#include <new>
#include <sstream>

namespace test_text {

using namespace shearwake;

TEST_CASE("edit distance counts insertions, deletions, replacements and transpositions", "[text]") {
    CHECK(edit_distance("", "") == 0);
    CHECK(edit_distance("speed", "speed") == 0);
    CHECK(edit_distance("", "abc") == 3);
    CHECK(edit_distance("abc", "") == 3);
    CHECK(edit_distance("speed", "sped") == 1);
    CHECK(edit_distance("speed", "spreed") == 1);
    CHECK(edit_distance("speed", "spied") == 1);
    CHECK(edit_distance("speed", "psede") == 2);
    CHECK(edit_distance("kitten", "sitting") == 3);
}

TEST_CASE("edit distance is symmetric", "[text]") {
    const std::string a = GENERATE("peak_Pa", "fwhm_mm", "", "x");
    const std::string b = GENERATE("pek_Pa", "whfm_mm", "duration_ms");
    CHECK(edit_distance(a, b) == edit_distance(b, a));
}

TEST_CASE("suggests the nearest candidate for a mistyped word and none for an unrelated one",
          "[text]") {
    const std::vector<std::string> words = {"peak_Pa", "footprint", "carrier"};
    CHECK(nearest("pek_Pa", words) == "peak_Pa");
    CHECK(nearest("fotoprint", words) == "footprint");
    CHECK(nearest("temperature", words) == std::nullopt);
    CHECK(nearest("anything", {}) == std::nullopt);
}

TEST_CASE("quotes the items of a list and joins them with a conjunction", "[text]") {
    const std::vector<std::string> words = {"a", "b", "c"};
    CHECK(quoted_list(words) == R"("a", "b" or "c")");
    CHECK(quoted_list(words, "and") == R"("a", "b" and "c")");
    CHECK(quoted_list(std::vector<std::string>{"a"}) == R"("a")");
    CHECK(quoted_list({}).empty());
}

TEST_CASE("exact text reads back as the same double", "[text]") {
    const double value = GENERATE(0.1, 1.0 / 3.0, 1e-300, -2.5e17, 0.00075, 5e-324);
    CHECK(std::strtod(exact(value).c_str(), nullptr) == value);
}

TEST_CASE("stable hash matches the published FNV-1a vectors", "[hash]") {
    // The published vectors of Fowler, Noll and Vo.
    CHECK(stable_hash("") == 0xcbf29ce484222325ULL);
    CHECK(stable_hash("a") == 0xaf63dc4c8601ec8cULL);
    CHECK(stable_hash("foobar") == 0x85944171f73967e8ULL);
    CHECK(hex(stable_hash("foobar")) == "85944171f73967e8");
    CHECK(hex(1) == "0000000000000001");
}

/// Gives some characters and then refuses memory, as the buffer of a file may.
class Refusing : public std::streambuf {
public:
    explicit Refusing(std::string text) : text_(std::move(text)) {
        setg(text_.data(), text_.data(), text_.data() + text_.size());
    }

private:
    int_type underflow() override { throw std::bad_alloc(); }
    std::string text_;
};

TEST_CASE("lines are read up to the end of the stream", "[text]") {
    std::istringstream in("one\n\nthree");
    std::vector<std::string> lines;
    for (std::string line; next_line(in, line);)
        lines.push_back(line);
    CHECK(lines == std::vector<std::string>{"one", "", "three"});
    std::istringstream words("a,b");
    std::string word;
    CHECK(next_line(words, word, ','));
    CHECK(word == "a");
}

TEST_CASE("memory refused while a line is read is not taken for the end of the stream", "[text]") {
    Refusing buffer("one\ntwo");
    std::istream in(&buffer);
    std::string line;
    CHECK(next_line(in, line));
    CHECK_THROWS_AS(next_line(in, line), std::bad_alloc);
}

} // namespace test_text
