// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <string>
#include <vector>

namespace shearwake::test {

/// Keeps this rank's checkpoint in memory. The run ends with the first save.
class StopAt : public engines::Checkpoints,
               public engines::StateWriter,
               public engines::StateReader {
public:
    explicit StopAt(int step) : left_(step) {}
    bool due() override { return --left_ == 0; }
    void save(const std::function<void(engines::StateWriter&)>& write) override { write(*this); }
    bool restore(const std::function<void(engines::StateReader&)>& read) override {
        if (numbers_.empty()) return false;
        read(*this);
        return true;
    }
    bool stop() const override { return true; }

    void put(const std::string& name, const engines::StateRows& rows,
             const double* values) override {
        rows_[name].assign(values, values + rows.count * rows.row_length);
    }
    void put(const std::string& name, double value) override { numbers_[name] = value; }
    void get(const std::string& name, const engines::StateRows&, double* values) override {
        std::copy(rows_.at(name).begin(), rows_.at(name).end(), values);
    }
    double get(const std::string& name) override { return numbers_.at(name); }

private:
    int left_;
    std::map<std::string, std::vector<double>> rows_;
    std::map<std::string, double> numbers_;
};

} // namespace shearwake::test
