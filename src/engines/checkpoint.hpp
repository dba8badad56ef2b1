#pragma once

#include <cstddef>
#include <functional>
#include <string>

namespace shearwake {

/// Rows of a global array [total][row_length] that this rank holds.
struct StateRows {
    std::ptrdiff_t total = 0, start = 0, count = 0, row_length = 0;
};

/// One state being written. Every member is collective over the team, in the same order on all
/// ranks; ranks may hold no rows. Between them the ranks hold every row once. Names are unique; an
/// engine puts its count of steps as "step", which the journal tells.
class StateWriter {
public:
    virtual ~StateWriter() = default;
    virtual void put(const std::string& name, const StateRows& rows, const double* values) = 0;
    virtual void put(const std::string& name, double value) = 0; // the same on all ranks
};

/// One state being read, on the same number of ranks or on another, in any order of names.
/// Collective as the writer is; ranks may ask for any rows. Throws CaseFailure on all ranks
/// together when `total` and `row_length` are not those that were written.
class StateReader {
public:
    virtual ~StateReader() = default;
    virtual void get(const std::string& name, const StateRows& rows, double* values) = 0;
    virtual double get(const std::string& name) = 0;
};

/// Decides when a run is saved, and keeps the states. Collective.
class Checkpoints {
public:
    virtual ~Checkpoints() = default;
    /// Asked after every step but the last: time to save? The same answer on all ranks.
    virtual bool due() = 0;
    /// A state that cannot be written (a full disk) is told and does not end the case.
    virtual void save(const std::function<void(StateWriter&)>& write) = 0;
    /// The newest whole state, if there is one that belongs to this case and program; false leaves
    /// `read` uncalled.
    virtual bool restore(const std::function<void(StateReader&)>& read) = 0;
    /// After a save: the run ends here (a stop was asked for).
    virtual bool stop() const = 0;
};

} // namespace shearwake
