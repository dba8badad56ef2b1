// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "parallel/spaced_question.hpp"

#include <functional>

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

} // namespace shearwake::serve
