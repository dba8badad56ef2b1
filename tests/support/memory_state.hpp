// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/state.hpp"

#include <algorithm>
#include <map>
#include <string>
#include <vector>

namespace shearwake::test {

/// A checkpoint in this rank's memory.
class MemoryState : public StateWriter, public StateReader {
public:
    void put(const std::string& name, const DistributedRows& rows, const double* values) override {
        rows_[name].assign(values, values + rows.count * rows.row_length);
    }
    void put(const std::string& name, double value) override { numbers_[name] = value; }
    void get(const std::string& name, const DistributedRows&, double* values) const override {
        std::copy(rows_.at(name).begin(), rows_.at(name).end(), values);
    }
    double get(const std::string& name) const override { return numbers_.at(name); }
    std::vector<double>& rows(const std::string& name) { return rows_.at(name); }
    bool empty() const { return numbers_.empty(); }
    bool operator==(const MemoryState& other) const {
        return rows_ == other.rows_ && numbers_ == other.numbers_;
    }

protected:
    std::map<std::string, std::vector<double>> rows_;
    std::map<std::string, double> numbers_;
};

} // namespace shearwake::test
