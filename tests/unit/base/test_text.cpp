// SPDX-License-Identifier: BSD-3-Clause
#include "base/text.hpp"

#include <catch2/catch.hpp>
#include <cstdio>
#include <cstdlib>
#include <fcntl.h>
#include <memory>
#include <new>
#include <sstream>
#include <unistd.h>

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

TEST_CASE("a terminal shows the words error and warning in colour where a message begins",
          "[text]") {
    const int terminal = ::posix_openpt(O_RDWR | O_NOCTTY);
    REQUIRE(terminal >= 0);
    REQUIRE(::grantpt(terminal) == 0);
    REQUIRE(::unlockpt(terminal) == 0);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> stream(
        std::fopen(::ptsname(terminal), "w"), &std::fclose);
    REQUIRE(stream);
    const char* given = std::getenv("NO_COLOR");
    const std::string before = given ? given : "";
    ::setenv("NO_COLOR", "", 1);
    const auto shown = [&](const std::string& text) { return coloured(text, stream.get()); };
    const std::string error = "\x1b[1;31merror:\x1b[0m", warning = "\x1b[1;33mwarning:\x1b[0m";
    CHECK(shown("error: a") == error + " a");
    CHECK(shown("a.toml:3:1: warning: b\nerror: c\n") ==
          "a.toml:3:1: " + warning + " b\n" + error + " c\n");
    CHECK(shown("no error: a") == "no error: a");
    CHECK(shown("error: error: a: error: b") == error + " error: a: " + error + " b");
    CHECK(shown("error:error:") == error + "error:");
    CHECK(shown("warning:") == warning);
    CHECK(shown("error\x1b") == "error?");
    CHECK(shown("") == "");
    ::setenv("NO_COLOR", "1", 1);
    CHECK(shown("error: a") == "error: a");
    ::setenv("NO_COLOR", before.c_str(), 1);
    ::close(terminal);
}

} // namespace test_text
