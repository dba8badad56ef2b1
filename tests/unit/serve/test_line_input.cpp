// SPDX-License-Identifier: BSD-3-Clause
#include "serve/streams.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <string_view>
#include <unistd.h>

namespace test_line_input {

using namespace shearwake;

/// A pipe whose reading end belongs to the input under test.
class Pipe {
public:
    Pipe() { REQUIRE(pipe(ends_.data()) == 0); }
    ~Pipe() {
        close_writer();
        close(ends_[0]);
    }
    Pipe(const Pipe&) = delete;
    Pipe& operator=(const Pipe&) = delete;

    int reader() const { return ends_[0]; }
    void write(std::string_view text) const {
        REQUIRE(::write(ends_[1], text.data(), text.size()) == static_cast<ssize_t>(text.size()));
    }
    void close_writer() {
        if (is_open_) close(ends_[1]);
        is_open_ = false;
    }

private:
    std::array<int, 2> ends_{};
    bool is_open_ = true;
};

static std::vector<std::string> texts(const std::vector<serve::Line>& lines) {
    std::vector<std::string> found;
    for (const serve::Line& line : lines)
        found.push_back(line.is_too_long ? "<too long>" : line.text);
    return found;
}

using Texts = std::vector<std::string>;

TEST_CASE("lines are returned when their end arrives", "[serve]") {
    Pipe pipe;
    serve::LineInput input(pipe.reader(), 100);
    CHECK(input.read(0).empty());
    pipe.write("fir");
    CHECK(input.read(0).empty());
    pipe.write("st\nsecond\n\nthi");
    CHECK(texts(input.read(0)) == Texts{"first", "second", ""});
    CHECK_FALSE(input.has_ended());
    pipe.close_writer();
    CHECK(input.read(0).empty()); // the incomplete line is discarded
    CHECK(input.has_ended());
}

TEST_CASE("a line longer than the limit has no text, and the next one is read", "[serve]") {
    Pipe pipe;
    serve::LineInput input(pipe.reader(), 8);
    pipe.write("12345678\n123456789\nnext\n");
    CHECK(texts(input.read(0)) == Texts{"12345678", "<too long>", "next"});
    Texts found;
    for (int part = 0; part < 100; ++part) { // arrives in parts
        pipe.write("1234567");
        for (const std::string& text : texts(input.read(0)))
            found.push_back(text);
    }
    CHECK(found.empty());
    pipe.write("\nafter\n");
    CHECK(texts(input.read(0)) == Texts{"<too long>", "after"});
}

} // namespace test_line_input
