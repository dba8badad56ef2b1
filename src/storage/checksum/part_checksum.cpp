// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checksum/checksum.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "storage/files.hpp"

#include <algorithm>
#include <atomic>
#include <fmt/format.h>
#include <fstream>
#include <mutex>
#include <new>
#include <sstream>
#include <thread>
#include <xxhash.h>

namespace shearwake::storage {

namespace {

constexpr std::uint64_t buffer_B = std::uint64_t{1} << 18;

/// An incremental hash.
class Growing {
public:
    Growing() : state_(XXH3_createState(), XXH3_freeState) {
        if (!state_) throw std::bad_alloc();
        XXH3_128bits_reset(state_.get());
    }
    /// Bytes [from, to) of the file.
    void add(std::ifstream& file, const std::filesystem::path& path, std::uint64_t from,
             std::uint64_t to) {
        std::vector<char> piece(std::min(buffer_B, to - from));
        file.clear();
        file.seekg(static_cast<std::streamoff>(from));
        for (std::uint64_t at = from; at < to;) {
            const std::uint64_t wanted = std::min(buffer_B, to - at);
            file.read(piece.data(), static_cast<std::streamsize>(wanted));
            if (static_cast<std::uint64_t>(file.gcount()) != wanted)
                throw UsageError(
                    fmt::format("cannot read {} bytes of {}", to - from, path.string()),
                    ExitCode::environment);
            XXH3_128bits_update(state_.get(), piece.data(), wanted);
            at += wanted;
        }
    }
    std::string digest() const {
        const XXH128_hash_t hash = XXH3_128bits_digest(state_.get());
        return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
    }

private:
    std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state_;
};

/// Checksum of all bytes outside the fields and of the size of the file.
std::string rest_of(std::ifstream& file, const std::filesystem::path& path,
                    std::vector<FieldBytes> fields) {
    std::ranges::sort(fields, {}, &FieldBytes::offset);
    const std::uint64_t size = regular_size_B(path);
    Growing hash;
    std::uint64_t at = 0;
    for (const FieldBytes& field : fields) {
        if (field.offset > at) hash.add(file, path, at, std::min(field.offset, size));
        at = std::max(at, field.offset + field.size);
    }
    if (at < size) hash.add(file, path, at, size);
    return fmt::format("rest {} {}", size, hash.digest());
}

std::ifstream opened(const std::filesystem::path& path) {
    std::ifstream file(path, std::ios::binary);
    if (!file)
        throw UsageError("cannot read " + path.string(), ExitCode::environment,
                         Persistence::passing);
    return file;
}

std::string line_of(const FieldBytes& field, const std::string& hash) {
    return fmt::format("{} {} {} {}\n", field.offset, field.size, field.written, hash);
}

} // namespace

struct PartChecksum::Hashes {
    struct Field {
        std::uint64_t offset = 0, added = 0;
        Growing hash;
    };
    std::vector<Field> fields;
};

PartChecksum::PartChecksum() : hashes_(std::make_unique<Hashes>()) {}
PartChecksum::~PartChecksum() = default;
PartChecksum::PartChecksum(PartChecksum&&) noexcept = default;
PartChecksum& PartChecksum::operator=(PartChecksum&&) noexcept = default;

std::string PartChecksum::record(const std::filesystem::path& part,
                                 const std::vector<FieldBytes>& fields) {
    std::ifstream file = opened(part);
    std::string record;
    for (const FieldBytes& field : fields) {
        auto known = std::ranges::find(hashes_->fields, field.offset, &Hashes::Field::offset);
        if (known == hashes_->fields.end()) {
            hashes_->fields.push_back({field.offset, 0, Growing()});
            known = hashes_->fields.end() - 1;
        }
        known->hash.add(file, part, field.offset + known->added, field.offset + field.written);
        known->added = field.written;
        record += line_of(field, known->hash.digest());
    }
    return record + rest_of(file, part, fields);
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

std::string bytes_error(const std::filesystem::path& part, const std::string& record) {
    if (record.empty()) return "has no checksum in the checkpoint";
    try {
        const std::vector<FieldBytes> fields = fields_of(record);
        const std::uint64_t size = regular_size_B(part);
        for (const FieldBytes& field : fields)
            if (field.offset + field.size > size || field.written > field.size)
                return "is shorter than when the checkpoint was saved";
        if (PartChecksum().record(part, fields) != record)
            return "is damaged (it does not match the checksum in the checkpoint)";
        return "";
    } catch (const Error& error) {
        return fmt::format("is damaged ({})", error.what());
    }
}

namespace {

/// More threads would make disks seek.
constexpr unsigned most_threads = 4;

double size_of(const std::filesystem::path& path) {
    std::error_code gone;
    const auto bytes = std::filesystem::file_size(path, gone);
    return gone ? 0.0 : static_cast<double>(bytes);
}

VerifiedFile verify(const std::filesystem::path& path) {
    try {
        return {check_integrity(path), ""};
    } catch (const std::exception& error) { // including failed allocations
        return {{}, error.what()};
    }
}

} // namespace

std::vector<VerifiedFile> verify_files(const std::vector<std::filesystem::path>& files,
                                       const std::function<void(const VerifyProgress&)>& report) {
    std::vector<VerifiedFile> verified(files.size());
    VerifyProgress progress{.all_files = files.size()};
    for (const auto& file : files)
        progress.all_bytes += size_of(file);
    std::atomic<std::size_t> next{0};
    std::mutex telling;
    const auto work = [&] {
        for (std::size_t i = next++; i < files.size(); i = next++) {
            verified[i] = verify(files[i]);
            const std::scoped_lock lock(telling);
            ++progress.files;
            progress.bytes += static_cast<double>(verified[i].check.bytes);
            if (report) report(progress);
        }
    };
    const std::size_t threads = std::min<std::size_t>(
        files.size(), std::clamp(std::thread::hardware_concurrency(), 1U, most_threads));
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < threads; ++i) {
        try {
            others.emplace_back(work);
        } catch (const std::system_error&) { // no more threads can be created
            break;
        }
    }
    work();
    others.clear(); // joins the threads
    return verified;
}

} // namespace shearwake::storage
