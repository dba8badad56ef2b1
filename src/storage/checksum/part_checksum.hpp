// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "storage/checksum/file_checksum.hpp"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace shearwake::storage {

/// The bytes of a field in a file that is being written. Its values are written in order, so that
/// at a checkpoint the first part is valid and the rest is undefined.
struct FieldBytes {
    std::uint64_t offset = 0, size = 0;
    std::uint64_t written = 0; // number of valid bytes from the start
};

/// Checksums of a file that is being written: of the valid part of each field, and of all bytes
/// outside the fields, which do not change. They are stored in the corresponding checkpoint. Reads
/// only the bytes added since the last call. Not collective.
class PartChecksum {
public:
    PartChecksum();
    ~PartChecksum();
    PartChecksum(PartChecksum&&) noexcept;
    PartChecksum& operator=(PartChecksum&&) noexcept;

    /// One line per field, `<offset> <size> <written> <hash>`, then one for the rest. Throws
    /// UsageError (environment) if the file cannot be read.
    std::string record(const std::filesystem::path& part, const std::vector<FieldBytes>& fields);

private:
    struct Hashes;
    std::unique_ptr<Hashes> hashes_;
};

/// The fields of a record; empty if it is not valid.
std::vector<FieldBytes> fields_of(const std::string& record);

/// The reason why the file does not match the record, as a phrase that follows its name; empty if
/// it matches. Does not interpret the file. Not collective.
std::string bytes_error(const std::filesystem::path& part, const std::string& record);

struct VerifyProgress {
    std::size_t files = 0, all_files = 0;
    double bytes = 0.0, all_bytes = 0.0;
};

/// The result of check_integrity() for one file; `unreadable`: the reason why it could not be read.
struct VerifiedFile {
    IntegrityCheck check;
    std::string unreadable;
};

/// Checks the files with a few threads. `report` is called after each file, by one thread at a
/// time. Not collective.
std::vector<VerifiedFile> verify_files(const std::vector<std::filesystem::path>& files,
                                       const std::function<void(const VerifyProgress&)>& report);

} // namespace shearwake::storage
