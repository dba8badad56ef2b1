// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/checksum.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <map>
#include <memory>
#include <sstream>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>
#include <xxhash.h>

namespace shearwake::storage {

namespace {

namespace fs = std::filesystem;

constexpr std::string_view line_begin = "shearwake checksum 1 XXH3-128 ";
constexpr std::string_view line_middle = " of ";
constexpr std::string_view line_end = " bytes\n";
constexpr std::size_t hash_digits = 32, size_digits = 20;
constexpr std::size_t line_length =
    line_begin.size() + hash_digits + line_middle.size() + size_digits + line_end.size();

/// Fits into the second-level cache.
constexpr std::size_t piece_B = std::size_t{1} << 18;

[[noreturn]] void cannot_read(const fs::path& path, int error) {
    throw UsageError(fmt::format("cannot read {}: {}", path.string(), std::strerror(error)),
                     ExitCode::environment, persistence_of(error));
}

/// A file that is open for reading.
class Input {
public:
    explicit Input(const fs::path& path)
        : path_(path), fd_(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK)) {
        if (fd_ < 0) cannot_read(path, errno);
        struct stat info {};
        const int failed = ::fstat(fd_, &info) != 0 ? errno
                           : S_ISREG(info.st_mode)  ? 0
                           : S_ISDIR(info.st_mode)  ? EISDIR
                                                    : EINVAL;
        if (failed != 0) {
            ::close(fd_);
            cannot_read(path, failed);
        }
        size_ = static_cast<std::uintmax_t>(info.st_size);
    }
    ~Input() { ::close(fd_); }
    Input(const Input&) = delete;
    Input& operator=(const Input&) = delete;

    std::uintmax_t size() const { return size_; }
    int fd() const { return fd_; }
    [[noreturn]] void refuse(int error) const { cannot_read(path_, error); }
    /// Reads up to `length` bytes from `offset`.
    std::size_t read(std::uintmax_t offset, char* into, std::size_t length) const {
        std::size_t done = 0;
        while (done < length) {
            const ssize_t got =
                ::pread(fd_, into + done, length - done, static_cast<off_t>(offset + done));
            if (got < 0 && errno == EINTR) continue;
            if (got < 0) refuse(errno);
            if (got == 0) break;
            done += static_cast<std::size_t>(got);
        }
        return done;
    }
    std::string text(std::uintmax_t offset, std::size_t length) const {
        std::string bytes(length, '\0');
        bytes.resize(read(offset, bytes.data(), length));
        return bytes;
    }

private:
    fs::path path_;
    int fd_;
    std::uintmax_t size_ = 0;
};

std::string hash_text(const XXH128_hash_t& hash) {
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

/// An incremental hash of bytes of a file.
class ByteHash {
public:
    ByteHash() : state_(XXH3_createState(), XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }
    /// Adds the bytes [from, to).
    void add(const Input& file, std::uintmax_t from, std::uintmax_t to) {
        if (from >= to) return;
        std::vector<char> piece(std::min<std::uintmax_t>(piece_B, to - from));
        for (std::uintmax_t at = from; at < to; at += piece.size()) {
            piece.resize(std::min<std::uintmax_t>(piece.size(), to - at));
            if (file.read(at, piece.data(), piece.size()) < piece.size()) file.refuse(EIO);
            XXH3_128bits_update(state_.get(), piece.data(), piece.size());
        }
    }
    std::string text() const { return hash_text(XXH3_128bits_digest(state_.get())); }

private:
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

std::string hash_of(const Input& file, std::uintmax_t bytes) {
    ::posix_fadvise(file.fd(), 0, 0, POSIX_FADV_SEQUENTIAL);
    ByteHash hash;
    hash.add(file, 0, bytes);
    return hash.text();
}

struct ChecksumLine {
    std::string hash;
    std::uintmax_t bytes = 0;
};

/// The line without its end.
std::string line_of(const std::string& hash, std::uintmax_t bytes) {
    return fmt::format("{}{}{}{:020}{}", line_begin, hash, line_middle, bytes,
                       line_end.substr(0, line_end.size() - 1));
}

/// Parses such a line, if the text is one.
bool parse(std::string_view text, ChecksumLine& line) {
    const std::size_t hash_at = line_begin.size();
    const std::size_t size_at = hash_at + hash_digits + line_middle.size();
    if (text.size() != line_length || !text.starts_with(line_begin) || !text.ends_with(line_end) ||
        text.substr(hash_at + hash_digits, line_middle.size()) != line_middle)
        return false;
    line.hash = text.substr(hash_at, hash_digits);
    const std::string_view digits = text.substr(size_at, size_digits);
    const auto [end, error] =
        std::from_chars(digits.data(), digits.data() + size_digits, line.bytes);
    return error == std::errc() && end == digits.data() + size_digits;
}

} // namespace

std::string append_checksum(std::string& bytes) {
    const XXH128_hash_t hash = XXH3_128bits(bytes.data(), bytes.size());
    std::string line = line_of(hash_text(hash), bytes.size());
    bytes += (bytes.ends_with('\n') ? "" : "\n") + line + "\n"; // as append_line() does
    return line;
}

std::string append_checksum(const fs::path& path) {
    std::string line;
    {
        const Input file(path);
#ifdef SYNC_FILE_RANGE_WRITE
        // Starts writing to the disk while the bytes are hashed.
        ::sync_file_range(file.fd(), 0, 0, SYNC_FILE_RANGE_WRITE);
#endif
        line = line_of(hash_of(file, file.size()), file.size());
    }
    append_line(path, line, Flush::later);
    return line;
}

namespace {

/// Whether the bytes are those of a complete HDF5 file, without what may follow.
bool is_complete_hdf5(const Input& file) {
    const std::string start = file.text(0, 48);
    if (start.size() < 48 || !start.starts_with("\x89HDF\r\n\x1a\n")) return false;
    std::uint64_t end = 0; // little-endian, at a place that depends on the version
    std::memcpy(&end, start.data() + (start[8] < 2 ? 40 : 28), sizeof end);
    return end <= file.size();
}

/// The line that the journals of the output folder have recorded last for a case file.
bool find_recorded(const fs::path& path, ChecksumLine& line) {
    const std::string id = "\"id\":\"" + path.stem().string() + "\"",
                      name = fmt::format("\"{}\":\"", recorded_checksum);
    bool found = false;
    const fs::path folder = fs::absolute(path).parent_path().parent_path();
    for (const std::string& file : names_in(folder)) {
        if (!file.starts_with("journal") || !file.ends_with(".jsonl") || is_stray(file)) continue;
        std::istringstream lines(read_file(folder / file));
        for (std::string text; next_line(lines, text);) {
            const std::size_t at = text.find(name);
            if (at == std::string::npos || text.find(id) == std::string::npos || !unseal(text))
                continue;
            const std::size_t begin = at + name.size();
            ChecksumLine one;
            if (parse(text.substr(begin, text.find('"', begin) - begin) + "\n", one)) {
                line = one;
                found = true;
            }
        }
    }
    return found;
}

/// The check of a file that does not end in its line.
IntegrityCheck check_without_line(const fs::path& path, const Input& file) {
    IntegrityCheck check{.damage = "", .bytes = file.size()};
    ChecksumLine line;
    const bool is_complete = is_complete_hdf5(file);
    if (is_complete && find_recorded(path, line) && line.bytes == file.size() &&
        hash_of(file, line.bytes) == line.hash)
        return check;
    check.damage = is_complete ? "the checksum at its end is missing: another program has opened "
                                 "it for writing and changed it, or it is not a shearwake case "
                                 "file; open case files for reading only: h5py.File(path, \"r\")"
                               : "the checksum at its end is missing: it is truncated, or not a "
                                 "shearwake case file";
    return check;
}

} // namespace

std::string checksum_in(const fs::path& path) try {
    const Input file(path);
    ChecksumLine line;
    if (file.size() < line_length) return "";
    std::string text = file.text(file.size() - line_length, line_length);
    if (!parse(text, line)) return "";
    text.pop_back();
    return text;
} catch (const UsageError&) {
    std::error_code ignored;
    if (fs::exists(path, ignored)) throw;
    return "";
}

IntegrityCheck check_integrity(const fs::path& path) {
    const Input file(path);
    IntegrityCheck check{.damage = "", .bytes = file.size()};
    ChecksumLine line;
    if (file.size() < line_length ||
        !parse(file.text(file.size() - line_length, line_length), line))
        return check_without_line(path, file);
    // append_line() first ends an incomplete last line.
    const std::uintmax_t before = file.size() - line_length;
    const bool fits =
        line.bytes == before || (line.bytes + 1 == before && file.text(line.bytes, 1) == "\n");
    if (!fits)
        check.damage =
            fmt::format("it has {} bytes, but its checksum covers {}", before, line.bytes);
    else if (hash_of(file, line.bytes) != line.hash)
        check.damage = "its bytes do not match its checksum";
    return check;
}

struct PartChecksum::Hashes {
    struct Field {
        std::uint64_t added = 0;
        ByteHash hash;
    };
    std::map<std::uint64_t, Field> fields; // by offset
};

std::string PartChecksum::record(const fs::path& part, std::vector<FieldBytes> fields) {
    if (!hashes_) hashes_ = std::make_shared<Hashes>();
    const Input file(part);
    std::string record;
    for (const FieldBytes& field : fields) {
        Hashes::Field& known = hashes_->fields[field.offset];
        known.hash.add(file, field.offset + known.added, field.offset + field.written);
        known.added = field.written;
        record += fmt::format("{} {} {} {}\n", field.offset, field.size, field.written,
                              known.hash.text());
    }
    std::ranges::sort(fields, {}, &FieldBytes::offset);
    ByteHash rest;
    // Without the four bytes of HDF5 that state whether the file is open for writing.
    constexpr std::uint64_t flags = 20, behind_flags = 24;
    rest.add(file, 0, std::min<std::uint64_t>(flags, file.size()));
    std::uint64_t at = behind_flags;
    for (const FieldBytes& field : fields) {
        rest.add(file, at, field.offset);
        at = std::max(at, field.offset + field.size);
    }
    rest.add(file, std::min<std::uint64_t>(at, file.size()), file.size());
    return record + fmt::format("rest {} {}", file.size(), rest.text());
}

std::vector<FieldBytes> fields_of(const std::string& record) {
    std::vector<FieldBytes> fields;
    std::istringstream lines(record);
    for (std::string line; next_line(lines, line);) {
        std::istringstream words(line);
        FieldBytes field;
        if (words >> field.offset >> field.size >> field.written) fields.push_back(field);
    }
    return fields;
}

std::string bytes_error(const fs::path& part, const std::string& record) {
    if (record.empty()) return "has no checksum in the checkpoint";
    try {
        const std::vector<FieldBytes> fields = fields_of(record);
        const std::uint64_t size = regular_size_B(part);
        for (const FieldBytes& field : fields)
            if (field.offset + field.size > size)
                return "is shorter than when the checkpoint was saved";
        if (PartChecksum().record(part, fields) != record)
            return "is damaged (it does not match the checksum in the checkpoint)";
        return "";
    } catch (const Error& error) {
        return fmt::format("is damaged ({})", error.what());
    }
}

namespace {

constexpr std::string_view member = ",\"checksum\":\"";
constexpr std::size_t digits = 16;
constexpr std::string_view white = " \t\r\n";

/// Position of the closing brace of the object; npos without one.
std::size_t end_of_object(std::string_view text) {
    const std::size_t at = text.find_last_not_of(white);
    return at != std::string_view::npos && text[at] == '}' ? at : std::string_view::npos;
}

} // namespace

std::string seal(std::string_view text) {
    const std::size_t end = end_of_object(text);
    std::string sealed(text.substr(0, end));
    sealed += member;
    sealed += hex(XXH3_64bits(text.data(), text.size()));
    sealed += '"';
    return sealed += text.substr(end);
}

std::optional<std::string> unseal(std::string_view text) {
    const std::size_t end = end_of_object(text);
    const std::size_t length = member.size() + digits + 1;
    if (end == std::string_view::npos || end < length) return std::nullopt;
    std::string plain(text.substr(0, end - length));
    plain += text.substr(end);
    return seal(plain) == text ? std::optional(plain) : std::nullopt;
}

} // namespace shearwake::storage
