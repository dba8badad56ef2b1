// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/json.hpp"
#include "engines/checkpoint.hpp"
#include "parallel/shared_counters.hpp"
#include "problem/case/case.hpp"
#include "problem/case/volume.hpp"

#include <cstdio>
#include <functional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::serve {

/// Ends the computation of a case, which saves nothing, when the root is asked to. Collective over
/// the team unless it says otherwise.
class Interrupt : public engines::Checkpoints {
public:
    /// `is_asked` is called on the root only. Not collective.
    Interrupt(const Comm& team, std::function<bool()> is_asked);

    bool due() override { return stop_asked(); }
    void save(const std::function<void(StateWriter&)>&) override {}
    bool restore(const std::function<void(const StateReader&)>&) override { return false; }
    bool stop() const override { return stops_; } // not collective
    bool stop_asked() override;
    void progressed(double) override {}

private:
    std::function<bool()> is_asked_;
    SpacedQuestion question_;
    bool stops_ = false;
};

/// A line of input without its end. A line longer than the limit has no text.
struct Line {
    std::string text;
    bool is_too_long = false;
};

/// Lines from a file descriptor. Memory does not exceed the longest line and one block, whatever
/// arrives. Not collective.
class LineInput {
public:
    LineInput(int descriptor, std::size_t longest) : descriptor_(descriptor), longest_(longest) {}

    /// Waits for input, at most `patience_ms` (-1: without limit), and returns the lines that one
    /// block of it completes.
    std::vector<Line> read(int patience_ms);
    /// Whether the input has ended. An incomplete last line is discarded.
    bool has_ended() const { return has_ended_; }

private:
    int descriptor_;
    std::size_t longest_;
    Line begun_;
    bool has_ended_ = false;
};

/// Version of the protocol (docs/reference/serve.md). A change that removes or renames a member, or
/// changes its meaning, increases it.
inline constexpr int protocol_version = 1;

/// The surface at all output times, [time][x][y] [m].
struct Frames {
    std::span<const float> u_z_m;
    std::ptrdiff_t count = 0, nx = 0, ny = 0;
};

/// Writes messages. Not collective: rank 0 calls it.
class Output {
public:
    explicit Output(std::FILE* stream) : stream_(stream) {}
    /// One line with a JSON object of type `type`, and its request unless it is negative.
    void message(const std::string& type, long request, const Json& members);
    /// The message `error` with its code and its text for users.
    void error(long request, const std::string& code, const std::string& text);
    /// The message `result`: the members, the scalars and the list of arrays, followed by the bytes
    /// of the arrays that are `wanted` and a newline.
    void result(long request, Json members, const std::vector<VariableGroup>& groups,
                const Frames& frames, const std::function<bool(const std::string&)>& wanted);
    /// Whether the output cannot be written any more, for example because its reader has ended.
    bool has_failed() const;

private:
    std::FILE* stream_;
};

} // namespace shearwake::serve
