// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"
#include "parallel/state.hpp"
#include "storage/hdf5/h5.hpp"

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace shearwake::storage {

/// A checkpoint belongs to a case (whose id is the hash of its canonical text) and to the program
/// that wrote it, since another version may store its state differently.
struct CheckpointOwner {
    std::string case_id;
    std::string git_id;
};

/// Metadata of a checkpoint.
struct CheckpointFacts {
    long sequence = 0;    // increases with every save
    double seconds = 0.0; // time for which the case has been computed
    std::string part;     // checksums of the corresponding unfinished case file; may be empty
};

/// Writes a checkpoint: part_path() of rank 0 until it is committed; removed if it is not.
/// Collective over the team; throws CaseFailure or UsageError (environment) on all ranks.
class CheckpointFileWriter : public StateWriter {
public:
    CheckpointFileWriter(const std::filesystem::path& path, const Comm& team);
    /// Not collective: rank 0 removes what was not committed. The file is abandoned (h5::Id).
    ~CheckpointFileWriter() override;
    CheckpointFileWriter(const CheckpointFileWriter&) = delete;
    CheckpointFileWriter& operator=(const CheckpointFileWriter&) = delete;

    /// Together, the ranks provide every row once.
    void put(const std::string& name, const DistributedRows& rows, const double* values) override;
    void put(const std::string& name, double value) override;
    /// The scalar that was put under this name; 0 if there is none.
    double scalar(const std::string& name) const;
    /// Writes owner, facts and scalars, and finally the line with the checksum of all bytes
    /// (checksum.hpp); flushes and renames the file.
    void commit(const CheckpointOwner& owner, const CheckpointFacts& facts);

private:
    std::filesystem::path path_, part_;
    Comm team_;
    h5::Id file_;
    std::map<std::string, double> scalars_;
    bool committed_ = false;
};

/// The reason why a file is not an undamaged checkpoint of this owner, as a phrase that follows its
/// name. Reads the file once and verifies its checksum before HDF5 opens it. If it can be used,
/// returns an empty string and fills `facts`. Not collective.
std::string checkpoint_error(const std::filesystem::path& path, const CheckpointOwner& owner,
                             CheckpointFacts& facts);

/// A checkpoint for which checkpoint_error() is empty, opened by the team. Collective, as the
/// writer. Abandoned by the destructor if it is not closed (h5::Id).
class CheckpointFileReader : public StateReader {
public:
    CheckpointFileReader(const std::filesystem::path& path, const Comm& team);

    void get(const std::string& name, const DistributedRows& rows, double* values) const override;
    double get(const std::string& name) const override;
    void close();

private:
    std::filesystem::path path_;
    Comm team_;
    h5::Id file_;
};

} // namespace shearwake::storage
