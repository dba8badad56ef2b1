// SPDX-License-Identifier: BSD-3-Clause
#include "storage/checkpoint/checkpoint_file.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
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

} // namespace

CheckpointFileWriter::CheckpointFileWriter(const std::filesystem::path& path, const Comm& team)
    : path_(path), part_(team.broadcast(part_path(path).string())), team_(team) {
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
    in_pieces(rows, team_, [&](std::ptrdiff_t start, std::ptrdiff_t count) {
        const double* piece = values + (start - rows.start) * rows.row_length;
        h5::write_block(dataset, block_of(start, count, rows.row_length),
                        View2<const double>(piece, count, rows.row_length),
                        "write " + part_.string(), team_);
    });
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
        h5::put_attribute(file.raw(), "file_type", "checkpoint");
        h5::put_attribute(file.raw(), "case_id", owner.case_id);
        h5::put_attribute(file.raw(), "git_id", owner.git_id);
        h5::put_attribute(file.raw(), "sequence", facts.sequence);
        h5::put_attribute(file.raw(), "seconds", facts.seconds);
        if (!facts.part.empty()) h5::put_attribute(file.raw(), "part", facts.part);
        h5::check(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), "flush " + part_.string());
        file.close("close " + part_.string());
        append_checksum(part_);
        publish(part_, path_);
        committed_ = true;
    });
}

std::string checkpoint_error(const std::filesystem::path& path, const CheckpointOwner& owner,
                             CheckpointFacts& facts) {
    try {
        if (checksum_in(path).empty())
            return "does not end in its checksum: it was truncated or changed, or is not a "
                   "checkpoint of this version";
        if (const IntegrityCheck check = check_integrity(path); !check.damage.empty())
            return fmt::format("is damaged ({})", check.damage);
        const h5::Id file = h5::open_file(path, h5::Access::read);
        if (h5::text_attribute(file.raw(), "case_id") != owner.case_id)
            return "belongs to another case";
        const std::string git_id = h5::text_attribute(file.raw(), "git_id");
        if (git_id != owner.git_id) return "was written by another program, " + git_id;
        facts.part =
            h5::has_attribute(file.raw(), "part") ? h5::text_attribute(file.raw(), "part") : "";
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

void CheckpointFileReader::get(const std::string& name, const DistributedRows& rows,
                               double* values) const {
    h5::Id dataset;
    together(team_, [&] {
        dataset = h5::open_dataset(file_.raw(), name).shared();
        const std::vector<hsize_t> expected = {static_cast<hsize_t>(rows.total),
                                               static_cast<hsize_t>(rows.row_length)};
        if (const auto shape = h5::shape(dataset); shape != expected)
            throw Error(fmt::format("{}: the array {} has the shape {}, expected {}",
                                    path_.string(), name, fmt::join(shape, " x "),
                                    fmt::join(expected, " x ")));
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

} // namespace shearwake::storage
