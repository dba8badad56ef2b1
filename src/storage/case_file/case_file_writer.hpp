// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/view.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "problem/case/volume.hpp"
#include "storage/case_file/groups.hpp"
#include "storage/checksum/checksum.hpp"
#include "storage/hdf5/h5.hpp"

#include <filesystem>
#include <vector>

namespace shearwake::storage {

/// The surface fields that a case stores: u_z(time, depth, x, y) in group /surface.
struct SurfaceLayout {
    Domain domain;
    std::vector<double> times_s;
    std::vector<double> depths_m;

    bool empty() const { return times_s.empty(); }
    double bytes() const;
};

/// Whether a case file is created from scratch or that of an earlier run is continued.
enum class Beginning { fresh, resume };

enum class HasVolume { no, yes };

inline constexpr double largest_in_memory_B = 1e6;

/// Writes a case file: part_path() of rank 0 until it is committed, then complete and renamed. It
/// is removed if it is not committed, unless it is left for a later run. xarray can open the
/// result: every variable has dimension scales, a unit and a long name.
class CaseFileWriter {
public:
    /// Collective. Rank 0 creates the file, then all ranks open it through MPI if surface fields
    /// will be written. A team of one rank uses no MPI, and keeps a file of up to
    /// `largest_in_memory_B` in memory until it is flushed or committed. Throws CaseFailure on all
    /// ranks (no space, no permission). `record`: that of the file that is continued, see
    /// part_record(). `volume`: whether begin_volume() follows.
    CaseFileWriter(const std::filesystem::path& path, const Comm& team, SurfaceLayout surface,
                   Beginning beginning = Beginning::fresh, const std::string& record = "",
                   HasVolume volume = HasVolume::no);
    /// Not collective: rank 0 removes what was not committed. An open file is abandoned (h5::Id).
    ~CaseFileWriter();
    CaseFileWriter(const CaseFileWriter&) = delete;
    CaseFileWriter& operator=(const CaseFileWriter&) = delete;

    /// Writes the rows of this rank from x_start of one surface field. Collective; ranks may have
    /// no rows.
    void write_surface(std::size_t time, std::size_t depth, View2<const double> u_z_m,
                       std::ptrdiff_t x_start);

    /// Allocates space for the volume snapshots, or finds it again, and memory for the `x_count`
    /// rows of this rank. Call once, before the first snapshot. Collective; throws CaseFailure on
    /// all ranks (no space).
    void begin_volume(VolumeLayout volume, std::ptrdiff_t x_count);
    const VolumeLayout& volume() const { return volume_; }
    /// Writes the rows of this rank from x_start of one level of a variable of the layout.
    /// Collective; ranks may have no rows.
    void write_volume(std::size_t variable, std::size_t time, std::size_t level,
                      View2<const double> values, std::ptrdiff_t x_start);

    /// Flushes all fields to the disk. Only their values have changed since the file was created,
    /// so it can be opened again even if the program is killed. Collective.
    void flush();
    /// Checksums of the content of the file after a flush, for the corresponding checkpoint; on
    /// rank 0, and empty elsewhere or if no fields are stored. Collective.
    std::string part_record();
    /// An uncommitted file remains for a later run. Not collective.
    void retain_uncommitted() { left_ = true; }
    /// Closes the uncommitted file, which remains for a later run. Collective.
    void leave_for_later();
    /// Closes the uncommitted file, which the destructor removes. Collective.
    void discard() { close_fields(); }

    /// Writes the rest of the file, flushes and renames it. Returns its checksum line on rank 0.
    /// Collective; only the arguments of rank 0 are written.
    std::string commit(const std::vector<VariableGroup>& groups,
                       const std::vector<Attribute>& attributes);

private:
    void create_surface();
    void open_fields();
    h5::Id open_field(const std::string& name) const;
    void close_fields();
    bool is_alone() const { return team_.size() == 1; }
    void store_image();
    void resume_counts(std::size_t first, std::size_t end, const Domain& domain);
    void count_plane(std::size_t field, std::uint64_t plane);
    void refuse_if_full(double needed_B) const;

    std::filesystem::path path_, part_;
    Comm team_;
    SurfaceLayout surface_;
    VolumeLayout volume_;
    h5::Id file_;        // of a team of one rank, until it is committed
    h5::Id shared_file_; // of a larger team, while fields are written
    h5::Id surface_field_;
    std::vector<h5::Id> volume_fields_; // one per variable
    std::vector<double> turned_;        // a plane of the volume with x contiguous
    // Number of planes of each field that are already written: of the surface, then of the volumes.
    std::vector<std::uint64_t> planes_;
    std::vector<FieldBytes> resumed_; // the fields of the record
    PartChecksum checksums_;          // on rank 0
    bool has_fields_ = false;         // the fields are open
    bool in_memory_ = false;
    bool committed_ = false, left_ = false;
};

/// Copies the unfinished case file that another process has left to part_path(), so that a process
/// that still writes to it cannot change the copy, and removes it. Not collective.
void inherit_part(const std::filesystem::path& path);

/// The reason why part_path() cannot be continued, as a phrase that follows its name. Empty if its
/// bytes match the record in the checkpoint, and it has these surface fields and, if stored, a
/// volume. Not collective.
std::string part_error(const std::filesystem::path& path, const std::string& record,
                       const SurfaceLayout& surface, HasVolume volume = HasVolume::no);

/// Writes `<case>.xdmf` next to a case file with frames, so that ParaView can open u_z [m] over
/// (x, y, depth) [m] and time [s]. Not collective.
void write_xdmf(const std::filesystem::path& case_file, const SurfaceLayout& layout);

/// Writes `<case>.volume.xdmf` next to a case file with volumes, so that ParaView can open each
/// component, and the displacement as a vector, over (x, y, z) [m] and time [s]. Not collective.
void write_volume_xdmf(const std::filesystem::path& case_file, const VolumeLayout& layout);

} // namespace shearwake::storage
