// SPDX-License-Identifier: BSD-3-Clause
#include "storage/case_file/case_file_writer.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/files.hpp"
#include "storage/hdf5/h5_block.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <functional>
#include <hdf5.h>

namespace shearwake::storage {
namespace {

std::vector<hsize_t> shape_of(const SurfaceLayout& layout) {
    return {layout.times_s.size(), layout.depths_m.size(), static_cast<hsize_t>(layout.domain.nx),
            static_cast<hsize_t>(layout.domain.ny)};
}

double bytes_of(const std::vector<VariableGroup>& groups) {
    double bytes = 0.0;
    for (const VariableGroup& group : groups)
        for (const Variable& variable : group.variables)
            bytes += static_cast<double>(variable.values.size() * sizeof(double));
    return bytes;
}

} // namespace

double SurfaceLayout::bytes() const {
    return static_cast<double>(times_s.size() * depths_m.size()) *
           static_cast<double>(domain.nx * domain.ny) * sizeof(double);
}

CaseFileWriter::CaseFileWriter(const std::filesystem::path& path, const Comm& team,
                               SurfaceLayout surface, Beginning beginning,
                               const std::string& record, HasVolume volume)
    : path_(path), part_(team.broadcast(part_path(path).string())), team_(team),
      surface_(std::move(surface)) {
    if (beginning == Beginning::resume) resumed_ = fields_of(team_.broadcast(record));
    in_memory_ = is_alone() && beginning == Beginning::fresh && volume == HasVolume::no &&
                 surface_.bytes() <= largest_in_memory_B;
    on_root(team_, [&] {
        if (beginning == Beginning::resume) return;
        refuse_if_full(surface_.bytes());
        try {
            create_surface();
        } catch (...) {
            std::error_code ignored;
            std::filesystem::remove(part_, ignored);
            throw;
        }
    });
    if (surface_.empty()) return;
    open_fields();
    resume_counts(0, 1, surface_.domain);
}

/// The fields [first, end) in the order of part_record().
void CaseFileWriter::resume_counts(std::size_t first, std::size_t end, const Domain& domain) {
    const auto plane_B = static_cast<std::uint64_t>(domain.nx * domain.ny) * sizeof(double);
    for (std::size_t i = first; i < std::min(end, resumed_.size()); ++i) {
        planes_.resize(std::max(planes_.size(), i + 1));
        planes_[i] = resumed_[i].written / plane_B;
    }
}

void CaseFileWriter::open_fields() {
    if (is_alone() && file_.raw() < 0)
        file_ = h5::open_file(part_, h5::Access::read_write);
    else if (!is_alone())
        shared_file_ = h5::open_shared(part_, team_);
    has_fields_ = true;
    if (!surface_.empty()) surface_field_ = open_field("surface/u_z");
}

h5::Id CaseFileWriter::open_field(const std::string& name) const {
    if (is_alone()) return h5::open_dataset(file_.raw(), name);
    return h5::open_dataset(shared_file_.raw(), name).shared();
}

void CaseFileWriter::close_fields() {
    if (!has_fields_) return;
    has_fields_ = false;
    if (is_alone()) {
        volume_fields_.clear();
        surface_field_ = {};
        return;
    }
    for (h5::Id& field : volume_fields_)
        field.close_shared("close a volume field", team_);
    volume_fields_.clear();
    if (!surface_.empty()) surface_field_.close_shared("close a surface field", team_);
    shared_file_.close_shared("close " + part_.string(), team_);
}

/// Continues a file in memory on the disk.
void CaseFileWriter::store_image() {
    if (!in_memory_) return;
    close_fields();
    write_file(part_, h5::image_of(file_));
    file_ = h5::open_file(part_, h5::Access::read_write);
    in_memory_ = false;
}

void CaseFileWriter::refuse_if_full(double needed_B) const {
    // Checked in advance, since an MPI write to a full disk may end the whole program.
    const double needed = needed_B + 1e6;
    const double free = free_bytes(path_.parent_path());
    if (free < needed)
        throw FileFailure(
            fmt::format(
                "cannot write {}: it requires {:.1f} MB, but the disk has only {:.1f} MB left",
                path_.string(), needed / 1e6, free / 1e6),
            Persistence::lasting);
}

CaseFileWriter::~CaseFileWriter() {
    if (committed_ || left_ || !team_.is_root()) return;
    std::error_code ignored;
    std::filesystem::remove(part_, ignored);
}

void CaseFileWriter::create_surface() {
    h5::Id file = h5::open_file(part_, in_memory_ ? h5::Access::in_memory : h5::Access::create);
    if (!surface_.empty()) {
        const h5::Id group = h5::create_group(file.raw(), "surface");
        const std::vector<Variable> axes = {
            {"time", {"time"}, surface_.times_s, "s", "time since the load began", ""},
            {"depth", {"depth"}, surface_.depths_m, "m", "depth below the skin surface", ""},
            x_coordinate(surface_.domain),
            y_coordinate(surface_.domain)};
        write_group(group.raw(), axes);
        create_field(group.raw(),
                     {.name = "u_z",
                      .dimensions = {"time", "depth", "x", "y"},
                      .units = "m",
                      .long_name = "normal displacement, positive into the tissue"},
                     shape_of(surface_));
    }
    if (is_alone())
        file_ = std::move(file);
    else
        file.close("close " + part_.string());
}

void CaseFileWriter::count_plane(std::size_t field, std::uint64_t plane) {
    if (field >= planes_.size()) planes_.resize(field + 1);
    if (planes_[field] == plane) ++planes_[field];
}

std::string CaseFileWriter::part_record() {
    if (!has_fields_) return "";
    std::string record;
    on_root(team_, [&] {
        std::vector<FieldBytes> fields;
        const auto add = [&](const h5::Id& dataset, std::uint64_t plane_B) {
            const haddr_t offset = H5Dget_offset(dataset.raw());
            if (offset == HADDR_UNDEF)
                throw Error("a field has no space allocated in the case file");
            const std::size_t n = fields.size();
            const std::uint64_t planes = n < planes_.size() ? planes_[n] : 0;
            fields.push_back({offset, H5Dget_storage_size(dataset.raw()), planes * plane_B});
        };
        if (!surface_.empty())
            add(surface_field_,
                static_cast<std::uint64_t>(surface_.domain.nx * surface_.domain.ny) *
                    sizeof(double));
        for (const h5::Id& volume : volume_fields_)
            add(volume,
                static_cast<std::uint64_t>(volume_.domain.nx * volume_.domain.ny) * sizeof(double));
        record = checksums_.record(part_, fields);
    });
    return record;
}

void CaseFileWriter::write_surface(std::size_t time, std::size_t depth, View2<const double> u_z_m,
                                   std::ptrdiff_t x_start) {
    const h5::Block block{
        {time, depth, static_cast<hsize_t>(x_start), 0},
        {1, 1, static_cast<hsize_t>(u_z_m.rows()), static_cast<hsize_t>(u_z_m.columns())}};
    h5::write_block(surface_field_, block, u_z_m, "write a surface field to " + part_.string(),
                    team_);
    count_plane(0, time * surface_.depths_m.size() + depth);
}

void CaseFileWriter::begin_volume(VolumeLayout volume, std::ptrdiff_t x_count) {
    volume_ = std::move(volume);
    together(team_,
             [&] { turned_.reserve(static_cast<std::size_t>(x_count * volume_.domain.ny)); });
    close_fields(); // only rank 0 changes the structure of the file
    on_root(team_, [&] {
        if (volume_.bytes() > largest_in_memory_B) store_image();
        h5::Id file;
        if (file_.raw() < 0) file = h5::open_file(part_, h5::Access::read_write);
        h5::Id& used = file_.raw() < 0 ? file : file_;
        if (!has_volume_group(used.raw(), volume_)) {
            // Space for the surface fields is allocated, but nothing is written yet.
            refuse_if_full(surface_.bytes() + volume_.bytes());
            create_volume_group(used.raw(), volume_);
        }
        if (file.raw() >= 0) file.close("close " + part_.string());
    });
    open_fields();
    for (const Variable& variable : volume_.variables())
        volume_fields_.push_back(open_field("volume/" + variable.name));
    resume_counts(surface_.empty() ? 0 : 1, resumed_.size(), volume_.domain);
}

void CaseFileWriter::write_volume(std::size_t variable, std::size_t time, std::size_t level,
                                  View2<const double> values, std::ptrdiff_t x_start) {
    const std::ptrdiff_t rows = values.rows(), ny = volume_.domain.ny;
    turned_.resize(static_cast<std::size_t>(rows * ny)); // within the capacity that was reserved
    for (std::ptrdiff_t j = 0; j < ny; ++j)
        for (std::ptrdiff_t i = 0; i < rows; ++i)
            turned_[static_cast<std::size_t>(j * rows + i)] = values(i, j);
    const h5::Block block{{time, level, 0, static_cast<hsize_t>(x_start)},
                          {1, 1, static_cast<hsize_t>(ny), static_cast<hsize_t>(rows)}};
    h5::write_block(volume_fields_.at(variable), block,
                    View2<const double>(turned_.data(), ny, rows),
                    "write a volume field to " + part_.string(), team_);
    count_plane((surface_.empty() ? 0 : 1) + variable, time * volume_.z_m.size() + level);
}

void CaseFileWriter::flush() {
    if (!has_fields_) return;
    if (in_memory_) return write_file(part_, h5::image_of(file_));
    h5::flush_shared(is_alone() ? file_ : shared_file_, "flush " + part_.string(), team_);
    on_root(team_, [&] { flush_to_disk(part_); });
}

void inherit_part(const std::filesystem::path& path) {
    namespace fs = std::filesystem;
    const fs::path own = part_path(path);
    std::vector<fs::path> left; // OMPIO leaves files next to those that it has opened
    std::error_code error;
    for (const std::string& name : names_in(path.parent_path()))
        if (name.starts_with(path.filename().string() + ".") &&
            !name.starts_with(own.filename().string()))
            left.push_back(path.parent_path() / name);
    std::ranges::sort(left, std::greater(), [&](const fs::path& file) {
        return std::pair(file.extension() == ".part", fs::last_write_time(file, error));
    });
    if (!left.empty() && !fs::copy_file(left.front(), own, error)) fs::remove(own, error);
    for (const fs::path& file : left)
        fs::remove(file, error);
}

std::string part_error(const std::filesystem::path& path, const std::string& record,
                       const SurfaceLayout& surface, HasVolume volume) {
    const std::filesystem::path part = part_path(path);
    if (!std::filesystem::exists(part)) return "is missing";
    if (const std::string reason = bytes_error(part, record); !reason.empty()) return reason;
    // Its structure matches what was written.
    try {
        const h5::Id file = h5::open_file(part, h5::Access::read);
        H5G_info_t root{};
        h5::check(H5Gget_info(file.raw(), &root), "inspect the root group");
        const hsize_t groups = (surface.empty() ? 0 : 1) + (volume == HasVolume::yes ? 1 : 0);
        if (root.nlinks != groups) return "was left incomplete by an interrupted run";
        if (surface.empty()) return "";
        const h5::Id field = h5::open_dataset(file.raw(), "surface/u_z");
        if (h5::shape(field) != shape_of(surface)) return "contains different surface fields";
        if (H5Dget_offset(field.raw()) == HADDR_UNDEF) return "has no space for its surface fields";
        return "";
    } catch (const Error& error) {
        return fmt::format("is damaged ({})", error.what());
    }
}

void CaseFileWriter::leave_for_later() {
    left_ = true;
    close_fields();
    if (is_alone() && file_.raw() >= 0) file_.close("close " + part_.string());
}

std::string CaseFileWriter::commit(const std::vector<VariableGroup>& groups,
                                   const std::vector<Attribute>& attributes) {
    close_fields();
    std::string line;
    on_root(team_, [&] {
        if (bytes_of(groups) > largest_in_memory_B) store_image();
        h5::Id file = std::move(file_);
        if (file.raw() < 0) file = h5::open_file(part_, h5::Access::read_write);
        write_groups(file.raw(), groups, attributes);
        if (in_memory_) {
            std::string bytes = h5::image_of(file);
            line = append_checksum(bytes);
            write_file(path_, bytes);
        } else {
            h5::check(H5Fflush(file.raw(), H5F_SCOPE_GLOBAL), "flush " + part_.string());
            file.close("close " + part_.string());
            line = append_checksum(part_);
            publish(part_, path_);
        }
        committed_ = true;
    });
    return line;
}

} // namespace shearwake::storage
