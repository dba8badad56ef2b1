// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "parallel/state.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace shearwake::test {

/// A checkpoint of a team that every rank holds in full and any number of ranks can restore. Rows
/// are distributed in ascending order of ranks.
class GatheredState : public StateWriter, public StateReader {
public:
    explicit GatheredState(const Comm& writers) : writers_(writers) {}

    void put(const std::string& name, const DistributedRows& rows, const double* values) override {
        rows_[name] = writers_.all_gather(std::span<const double>(
            values, static_cast<std::size_t>(rows.count * rows.row_length)));
    }
    void put(const std::string& name, double value) override { numbers_[name] = value; }
    void get(const std::string& name, const DistributedRows& rows, double* values) const override {
        std::copy_n(rows_.at(name).begin() + rows.start * rows.row_length,
                    rows.count * rows.row_length, values);
    }
    double get(const std::string& name) const override { return numbers_.at(name); }
    const std::vector<double>& rows(const std::string& name) const { return rows_.at(name); }

private:
    Comm writers_;
    std::map<std::string, std::vector<double>> rows_;
    std::map<std::string, double> numbers_;
};

} // namespace shearwake::test
