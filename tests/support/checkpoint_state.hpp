#pragma once

#include "engines/checkpoint.hpp"
#include "io/checkpoint_file.hpp"

namespace shearwake::test {

/// What an engine tells, into a real file and back.
class StateToFile : public StateWriter {
public:
    explicit StateToFile(CheckpointFileWriter& file) : file_(file) {}
    void put(const std::string& name, const StateRows& r, const double* values) override {
        file_.put(name, RowRange{r.total, r.start, r.count, r.row_length}, values);
    }
    void put(const std::string& name, double value) override { file_.put(name, value); }

private:
    CheckpointFileWriter& file_;
};

class StateFromFile : public StateReader {
public:
    explicit StateFromFile(const CheckpointFileReader& file) : file_(file) {}
    void get(const std::string& name, const StateRows& r, double* values) override {
        file_.get(name, RowRange{r.total, r.start, r.count, r.row_length}, values);
    }
    double get(const std::string& name) override { return file_.get(name); }

private:
    const CheckpointFileReader& file_;
};

} // namespace shearwake::test
