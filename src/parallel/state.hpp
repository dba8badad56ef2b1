// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>

namespace shearwake {

/// The rows of a global array [total][row_length] that this rank holds.
struct DistributedRows {
    std::ptrdiff_t total = 0, start = 0, count = 0, row_length = 0;
};

/// A checkpoint that is being written. Every member function is collective over the team and called
/// in the same order on all ranks. Each row is held by exactly one rank; a rank may hold none.
/// Names are unique. An engine writes its number of steps as "step", which the journal reports.
class StateWriter {
public:
    virtual ~StateWriter() = default;
    virtual void put(const std::string& name, const DistributedRows& rows,
                     const double* values) = 0;
    virtual void put(const std::string& name, double value) = 0; // identical on all ranks
};

/// A checkpoint that is being read, on any number of ranks and in any order of names. Every member
/// function is collective over the team; a rank may request any rows. Throws CaseFailure on all
/// ranks if `total` or `row_length` differ from the written ones.
class StateReader {
public:
    virtual ~StateReader() = default;
    virtual void get(const std::string& name, const DistributedRows& rows,
                     double* values) const = 0;
    virtual double get(const std::string& name) const = 0;
};

} // namespace shearwake
