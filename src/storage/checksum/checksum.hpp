// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace shearwake::storage {

/// Case files and checkpoints end in one line of text,
///     shearwake checksum 1 XXH3-128 <32 hexadecimal digits> of <20 digits> bytes
/// with the hash of every byte before it. HDF5 ignores what follows its own end of file, so every
/// HDF5 reader can open such a file. The hash covers data, attributes and HDF5's own metadata,
/// independently of how many ranks wrote them, and is checked without the HDF5 library, which
/// crashes on some damaged files. HDF5's own filter Fletcher32 would protect neither its metadata
/// nor 16-bit words that change from 0 to 0xffff, and its collective writes take 2 to 3 times as
/// long.

struct IntegrityCheck {
    std::string damage;       // empty: the file matches its checksum
    std::uintmax_t bytes = 0; // of the file
};

/// The root attribute of a case file that describes the line to other readers.
inline constexpr const char* checksum_attribute = "checksum";
inline constexpr const char* checksum_promise =
    "XXH3-128 of all bytes before the last line of this file, in that line";

/// Appends the line to the bytes of a file, and returns it without its end.
std::string append_checksum(std::string& bytes);

/// Reads the file once, appends the line, and returns it without its end. Throws UsageError
/// (environment). Not collective.
std::string append_checksum(const std::filesystem::path& path);

/// Reads the file once, at the speed of the disk. A case file without its line, which HDF5 removes
/// when a program opens the file for writing, is compared with the line that the journal of its
/// output folder has recorded. Throws UsageError (environment) when it cannot be read. Not
/// collective.
IntegrityCheck check_integrity(const std::filesystem::path& path);

/// The last line of a protected file without its end; empty if it has none, or has been removed,
/// which the run that wrote it reports at its end. Throws UsageError (environment). Not collective.
std::string checksum_in(const std::filesystem::path& path);

/// The member of a line of the journal that contains the last line of a case file.
inline constexpr const char* recorded_checksum = "file_checksum";

/// A JSON object with its own checksum as last member: `{...}` becomes `{...,"checksum":"<16
/// hexadecimal digits>"}`, XXH3-64 of the text without that member. Text after the object (the end
/// of a line) is preserved.

/// `text` must end in a JSON object with members, and white space.
std::string seal(std::string_view text);

/// The text without its checksum; none if the checksum is missing or does not match.
std::optional<std::string> unseal(std::string_view text);

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
    /// One line per field, `<offset> <size> <written> <hash>`, then one for the rest. Throws
    /// UsageError (environment) if the file cannot be read.
    std::string record(const std::filesystem::path& part, std::vector<FieldBytes> fields);

private:
    struct Hashes;
    std::shared_ptr<Hashes> hashes_;
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
