// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "support/memory_state.hpp"

namespace shearwake::test {

/// A checkpoint of a team that every rank holds in full and any number of ranks can restore. Rows
/// are distributed in ascending order of ranks.
class GatheredState : public MemoryState {
public:
    explicit GatheredState(const Comm& writers) : writers_(writers) {}

    using MemoryState::get, MemoryState::put;
    void put(const std::string& name, const DistributedRows& rows, const double* values) override {
        rows_[name] = writers_.all_gather(std::span<const double>(
            values, static_cast<std::size_t>(rows.count * rows.row_length)));
    }
    void get(const std::string& name, const DistributedRows& rows, double* values) const override {
        std::copy_n(rows_.at(name).begin() + rows.start * rows.row_length,
                    rows.count * rows.row_length, values);
    }

private:
    Comm writers_;
};

} // namespace shearwake::test
