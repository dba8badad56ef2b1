// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checkpoint/checkpoint_file.hpp"

#include "base/error.hpp"
#include "base/text.hpp"
#include "parallel/agree.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <hdf5.h>
#include <vector>

namespace shearwake::storage {

namespace {

/// MPI counts bytes in an int, and reading requires memory, so larger blocks are split.
constexpr std::ptrdiff_t most_values_at_once = std::ptrdiff_t{1} << 23; // 64 MiB

/// Splits the rows of this rank into pieces and calls `one(first row, rows)` the same number of
/// times on every rank. Collective.
void in_pieces(const DistributedRows& rows, const Comm& team,
               const std::function<void(std::ptrdiff_t, std::ptrdiff_t)>& one) {
    const std::ptrdiff_t most = std::max<std::ptrdiff_t>(
        1, most_values_at_once / std::max<std::ptrdiff_t>(1, rows.row_length));
    const int pieces = team.max(static_cast<int>((rows.count + most - 1) / most));
    for (std::ptrdiff_t done = 0, i = 0; i < pieces; ++i) {
        const std::ptrdiff_t count = std::min(most, rows.count - done);
        one(rows.start + done, count);
        done += count;
    }
}

h5::Block block_of(std::ptrdiff_t start, std::ptrdiff_t count, std::ptrdiff_t row_length) {
    return {{static_cast<hsize_t>(start), 0},
            {static_cast<hsize_t>(count), static_cast<hsize_t>(row_length)}};
}

std::string digest(const std::map<std::string, double>& scalars, const std::string& part) {
    std::uint64_t hash = stable_hash(part);
    for (const auto& [name, value] : scalars)
        hash = stable_hash(fmt::format("{}={:a}\n", name, value), hash);
    return hex(hash);
}

std::map<std::string, double> read_scalars(hid_t group) {
    std::map<std::string, double> scalars;
    for (const std::string& name : h5::attribute_names(group))
        scalars[name] = h5::number_attribute(group, name);
    return scalars;
}

/// The shape of an array, which must be stored completely.
DistributedRows extent_of(const h5::Id& dataset) {
    const auto shape = h5::shape(dataset);
    if (shape.size() != 2) throw Error("an array is not two-dimensional");
    if (static_cast<double>(shape[0]) * static_cast<double>(shape[1]) * sizeof(double) !=
        static_cast<double>(H5Dget_storage_size(dataset.raw())))
        throw Error("an array stores fewer or more values than it states");
    return {.total = static_cast<std::ptrdiff_t>(shape[0]),
            .row_length = static_cast<std::ptrdiff_t>(shape[1])};
}

/// Checks everything except the values of the arrays, which HDF5 does not interpret.
void look_at_all(const std::filesystem::path& path) {
    const h5::Id file = h5::open_file(path, h5::Access::read);
    read_scalars(h5::open_group(file.raw(), "scalars").raw());
    for (const char* name : {"whole", "case_id", "git_id", "part"})
        if (h5::has_attribute(file.raw(), name)) h5::text_attribute(file.raw(), name);
    for (const std::string& name : h5::dataset_names(file.raw())) {
        const h5::Id dataset = h5::open_dataset(file.raw(), name);
        extent_of(dataset);
        h5::text_attribute(dataset.raw(), "checksum");
    }
}

} // namespace

CheckpointFileWriter::CheckpointFileWriter(const std::filesystem::path& path, const Comm& team)
    : path_(path), part_(path.string() + ".part"), team_(team) {
    on_root(team_, [&] {
        make_directory(path_.parent_path());
        h5::open_file(part_, h5::Access::create).close("close " + part_.string());
    });
    file_ = h5::open_shared(part_, team_);
}

CheckpointFileWriter::~CheckpointFileWriter() {
    if (committed_ || !team_.is_root()) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void CheckpointFileWriter::put(const std::string& name, const DistributedRows& rows,
                               const double* values) {
    on_root(team_, [&] {
        // Checked in advance, since an MPI write to a full disk may end the whole program.
        const double needed = 8.0 * static_cast<double>(rows.total * rows.row_length) + 1e6;
        const double free = free_bytes(part_.parent_path());
        if (free < needed)
            throw FileFailure(
                fmt::format("it requires {:.1f} MB, but the disk has only {:.1f} MB left",
                            needed / 1e6, free / 1e6),
                Persistence::lasting);
    });
    const hsize_t shape[2] = {static_cast<hsize_t>(rows.total),
                              static_cast<hsize_t>(rows.row_length)};
    h5::Id dataset = h5::create_shared_dataset(file_, name, shape, team_);
    RowChecksum checksum;
    in_pieces(rows, team_, [&](std::ptrdiff_t start, std::ptrdiff_t count) {
        const double* piece = values + (start - rows.start) * rows.row_length;
        for (std::ptrdiff_t i = 0; i < count; ++i)
            checksum.add(start + i, piece + i * rows.row_length, rows.row_length);
        h5::write_block(dataset, block_of(start, count, rows.row_length),
                        View2<const double>(piece, count, rows.row_length),
                        "write " + part_.string(), team_);
    });
    checksums_[name] = checksum.over(team_);
    dataset.close_shared("close " + name, team_);
}

void CheckpointFileWriter::put(const std::string& name, double value) {
    scalars_[name] = value;
}

double CheckpointFileWriter::scalar(const std::string& name) const {
    const auto found = scalars_.find(name);
    return found == scalars_.end() ? 0.0 : found->second;
}

void CheckpointFileWriter::commit(const CheckpointOwner& owner, const CheckpointFacts& facts) {
    file_.close_shared("close " + part_.string(), team_);
    on_root(team_, [&] {
        h5::Id file = h5::open_file(part_, h5::Access::read_write);
        {
            const h5::Id group = h5::create_group(file.raw(), "scalars");
            for (const auto& [name, value] : scalars_)
                h5::put_attribute(group.raw(), name, value);
        }
        for (const auto& [name, sum] : checksums_)
            h5::put_attribute(h5::open_dataset(file.raw(), name).raw(), "checksum", sum);
        h5::put_attribute(file.raw(), "file_type", "checkpoint");
        h5::put_attribute(file.raw(), "case_id", owner.case_id);
        h5::put_attribute(file.raw(), "git_id", owner.git_id);
        h5::put_attribute(file.raw(), "sequence", facts.sequence);
        h5::put_attribute(file.raw(), "seconds", facts.seconds);
        if (!facts.part.empty()) h5::put_attribute(file.raw(), "part", facts.part);
        h5::put_attribute(file.raw(), "whole", digest(scalars_, facts.part));
        h5::check(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), "flush " + part_.string());
        file.close("close " + part_.string());
        publish(part_, path_);
        committed_ = true;
    });
}

std::string checkpoint_error(const std::filesystem::path& path, const CheckpointOwner& owner,
                             CheckpointFacts& facts) {
    try {
        look_at_all(path);
        const h5::Id file = h5::open_file(path, h5::Access::read);
        if (!h5::has_attribute(file.raw(), "whole")) return "is not complete";
        if (h5::text_attribute(file.raw(), "case_id") != owner.case_id)
            return "belongs to another case";
        const std::string git_id = h5::text_attribute(file.raw(), "git_id");
        if (git_id != owner.git_id) return "was written by another program, " + git_id;
        const h5::Id group = h5::open_group(file.raw(), "scalars");
        facts.part =
            h5::has_attribute(file.raw(), "part") ? h5::text_attribute(file.raw(), "part") : "";
        if (digest(read_scalars(group.raw()), facts.part) !=
            h5::text_attribute(file.raw(), "whole"))
            return "is damaged (its scalars do not match their checksum)";
        facts.sequence = std::lround(h5::number_attribute(file.raw(), "sequence"));
        facts.seconds = h5::number_attribute(file.raw(), "seconds");
        return "";
    } catch (const Error& error) {
        return fmt::format("is damaged ({})", error.what());
    }
}

CheckpointFileReader::CheckpointFileReader(const std::filesystem::path& path, const Comm& team)
    : path_(path), team_(team), file_(h5::open_shared(path, team, h5::Access::read)) {}

void CheckpointFileReader::close() {
    file_.close_shared("close " + path_.string(), team_);
}

std::string CheckpointFileReader::damage() const {
    std::vector<std::string> names;
    together(team_, [&] { names = h5::dataset_names(file_.raw()); });
    for (const std::string& name : names) {
        h5::Id dataset;
        DistributedRows rows;
        std::string written;
        std::vector<double> piece;
        together(team_, [&] {
            dataset = h5::open_dataset(file_.raw(), name).shared();
            rows = extent_of(dataset);
            written = h5::text_attribute(dataset.raw(), "checksum");
            rows.start = rows.total * team_.rank() / team_.size();
            rows.count = rows.total * (team_.rank() + 1) / team_.size() - rows.start;
            const std::ptrdiff_t most = std::max(most_values_at_once, rows.row_length);
            piece.resize(static_cast<std::size_t>(std::min(most, rows.count * rows.row_length)));
        });
        RowChecksum checksum;
        in_pieces(rows, team_, [&](std::ptrdiff_t start, std::ptrdiff_t count) {
            h5::read_block(dataset, block_of(start, count, rows.row_length),
                           View2<double>(piece.data(), count, rows.row_length),
                           "read " + path_.string(), team_);
            for (std::ptrdiff_t i = 0; i < count; ++i)
                checksum.add(start + i, piece.data() + i * rows.row_length, rows.row_length);
        });
        dataset.close_shared("close " + name, team_);
        if (checksum.over(team_) != written)
            return fmt::format("is damaged ({} does not match its checksum)", name);
    }
    return "";
}

void CheckpointFileReader::get(const std::string& name, const DistributedRows& rows,
                               double* values) const {
    h5::Id dataset;
    together(team_, [&] {
        dataset = h5::open_dataset(file_.raw(), name).shared();
        const DistributedRows there = extent_of(dataset);
        if (there.total != rows.total || there.row_length != rows.row_length)
            throw Error(fmt::format("{}: the array {} has the shape {} x {}, expected {} x {}",
                                    path_.string(), name, there.total, there.row_length, rows.total,
                                    rows.row_length));
    });
    in_pieces(rows, team_, [&](std::ptrdiff_t start, std::ptrdiff_t count) {
        double* piece = values + (start - rows.start) * rows.row_length;
        h5::read_block(dataset, block_of(start, count, rows.row_length),
                       View2<double>(piece, count, rows.row_length), "read " + path_.string(),
                       team_);
    });
    dataset.close_shared("close " + name, team_);
}

double CheckpointFileReader::get(const std::string& name) const {
    double value = 0.0;
    together(team_, [&] {
        const h5::Id group = h5::open_group(file_.raw(), "scalars");
        value = h5::number_attribute(group.raw(), name);
    });
    return value;
}

void RowChecksum::add(std::ptrdiff_t row, const double* values, std::ptrdiff_t length) {
    // The odd multiplier of splitmix64 (Steele, Lea, Flood 2014), each word mixed in turn.
    constexpr std::uint64_t odd = 0x9e3779b97f4a7c15ULL;
    std::uint64_t hash = (static_cast<std::uint64_t>(row) + 1) * odd;
    for (std::ptrdiff_t i = 0; i < length; ++i)
        hash = (std::rotl(hash, 23) ^ std::bit_cast<std::uint64_t>(values[i])) * odd;
    sum_ += hash ^ (hash >> 31);
}

std::string RowChecksum::over(const Comm& comm) const {
    // Sums of 32-bit halves are exact in doubles for up to two million ranks.
    std::array<double, 2> halves = {static_cast<double>(sum_ & 0xffffffffULL),
                                    static_cast<double>(sum_ >> 32)};
    comm.sum(halves);
    return hex(static_cast<std::uint64_t>(halves[0]) +
               (static_cast<std::uint64_t>(halves[1]) << 32));
}

} // namespace shearwake::storage
