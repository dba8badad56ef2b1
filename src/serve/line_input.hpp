// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "parallel/shared_counters.hpp"

#include <functional>
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

} // namespace shearwake::serve
