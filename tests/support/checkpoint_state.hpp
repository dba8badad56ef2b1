// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"

namespace shearwake::test {

/// Write the state of an engine to a checkpoint file and read it back.
class StateToFile : public engines::StateWriter {
public:
    explicit StateToFile(storage::CheckpointFileWriter& file) : file_(file) {}
    void put(const std::string& name, const engines::StateRows& r, const double* values) override {
        file_.put(name, storage::RowRange{r.total, r.start, r.count, r.row_length}, values);
    }
    void put(const std::string& name, double value) override { file_.put(name, value); }

private:
    storage::CheckpointFileWriter& file_;
};

class StateFromFile : public engines::StateReader {
public:
    explicit StateFromFile(const storage::CheckpointFileReader& file) : file_(file) {}
    void get(const std::string& name, const engines::StateRows& r, double* values) override {
        file_.get(name, storage::RowRange{r.total, r.start, r.count, r.row_length}, values);
    }
    double get(const std::string& name) override { return file_.get(name); }

private:
    const storage::CheckpointFileReader& file_;
};

} // namespace shearwake::test
