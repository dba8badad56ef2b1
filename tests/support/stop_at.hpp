// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "support/memory_state.hpp"

#include <functional>

namespace shearwake::test {

/// Checkpoints that are never due.
class NoCheckpoints : public engines::Checkpoints {
public:
    bool due() override { return false; }
    void save(const std::function<void(StateWriter&)>& /*write*/) override {}
    bool restore(const std::function<void(const StateReader&)>& /*read*/) override { return false; }
    bool stop() const override { return false; }
    bool stop_asked() override { return false; }
    void progressed(double /*share*/) override {}
};

/// Keeps this rank's checkpoint in memory. The run ends with the first save.
class StopAt : public engines::Checkpoints {
public:
    explicit StopAt(int step) : left_(step) {}
    bool due() override { return --left_ == 0; }
    void save(const std::function<void(StateWriter&)>& write) override { write(state_); }
    bool restore(const std::function<void(const StateReader&)>& read) override {
        if (state_.empty()) return false;
        read(state_);
        return true;
    }
    bool stop() const override { return true; }
    bool stop_asked() override { return false; }
    void progressed(double /*share*/) override {}

private:
    int left_;
    MemoryState state_;
};

/// Stores the reported shares; nothing is saved.
class Shares : public NoCheckpoints {
public:
    void progressed(double share) override { all.push_back(share); }

    std::vector<double> all;
};

} // namespace shearwake::test
