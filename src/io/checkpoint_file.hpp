#pragma once

#include "io/h5.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <map>
#include <string>

namespace shearwake {

/// A state belongs to a case (its id is the hash of its canonical text) and to the program that
/// wrote it, and to nothing else: another program may keep its state another way.
struct CheckpointOwner {
    std::string case_id;
    std::string git_id;
};

/// What a state says of itself.
struct CheckpointFacts {
    long sequence = 0;    // grows from save to save
    double seconds = 0.0; // that the case has been computed for
};

/// Rows of an array [total][row_length] that this rank holds.
struct RowRange {
    std::ptrdiff_t total = 0, start = 0, count = 0, row_length = 0;
};

/// A state in the making: `<path>.part` until it is committed; removed when it is not. Collective
/// over the team; throws CaseFailure or UsageError (environment) on all ranks together.
class CheckpointFileWriter {
public:
    CheckpointFileWriter(const std::filesystem::path& path, const Comm& team);
    /// Not collective: rank 0 removes what was not committed.
    ~CheckpointFileWriter();
    CheckpointFileWriter(const CheckpointFileWriter&) = delete;
    CheckpointFileWriter& operator=(const CheckpointFileWriter&) = delete;

    /// Between them the ranks give every row once.
    void put(const std::string& name, const RowRange& rows, const double* values);
    void put(const std::string& name, double value);
    /// Owner, facts and scalars, and last of all the word that it is whole; flushed, renamed.
    void commit(const CheckpointOwner& owner, const CheckpointFacts& facts);

private:
    std::filesystem::path path_, part_;
    Comm team_;
    h5::Id file_;
    std::map<std::string, double> scalars_;
    bool committed_ = false;
};

/// Why a file is no state of this owner, in words that follow its name; empty when it is one, as
/// far as its attributes tell. `facts` are filled then. Not collective.
std::string trouble_with_checkpoint(const std::filesystem::path& path, const CheckpointOwner& owner,
                                    CheckpointFacts& facts);

/// A whole state, opened by the team. Collective as the writer is.
class CheckpointFileReader {
public:
    CheckpointFileReader(const std::filesystem::path& path, const Comm& team);

    /// Reads everything once against its checksums: what is damaged, or nothing. The same on all
    /// ranks.
    std::string damage() const;
    void get(const std::string& name, const RowRange& rows, double* values) const;
    double get(const std::string& name) const;

private:
    std::filesystem::path path_;
    Comm team_;
    h5::Id file_;
};

} // namespace shearwake
