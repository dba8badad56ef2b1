#pragma once

#include "base/view.hpp"
#include "io/h5.hpp"
#include "io/volume_group.hpp"
#include "model/case.hpp"
#include "model/record.hpp"
#include "parallel/comm.hpp"

#include <filesystem>
#include <vector>

namespace shearwake {

/// The surface fields that a case keeps: u_z(time, depth, x, y) in group /surface.
struct SurfaceLayout {
    Domain domain;
    std::vector<double> times_s;
    std::vector<double> depths_m;

    bool empty() const { return times_s.empty(); }
    double bytes() const;
};

/// Whether a case file is begun anew, or what an earlier run has left of it is written on.
enum class Beginning { anew, go_on };

/// A case file in the making: `<path>.part` until it is committed, then whole and renamed; removed
/// when it is not, unless it is left for a later run. xarray opens the result as it is: dimension
/// scales, units and long names on every variable.
class CaseFileWriter {
public:
    /// Collective. Rank 0 creates the file, then all ranks open it through MPI if there are surface
    /// fields to come. Throws CaseFailure on all ranks (no space, no permission).
    CaseFileWriter(const std::filesystem::path& path, const Comm& team, SurfaceLayout surface,
                   Beginning beginning = Beginning::anew);
    /// Not collective: rank 0 removes what was not committed.
    ~CaseFileWriter();
    CaseFileWriter(const CaseFileWriter&) = delete;
    CaseFileWriter& operator=(const CaseFileWriter&) = delete;

    /// This rank's rows x_start ... of one surface field. Collective; ranks may have no rows.
    void write_surface(std::size_t time, std::size_t depth, View2<const double> u_z_m,
                       std::ptrdiff_t x_start);

    /// Makes room for the volume snapshots, or finds it again, and memory for the `x_count` rows of
    /// this rank. Once, before any of them. Collective; throws CaseFailure on all ranks together
    /// (no space).
    void begin_volume(VolumeLayout volume, std::ptrdiff_t x_count);
    const VolumeLayout& volume() const { return volume_; }
    /// This rank's rows x_start ... of one level of one of the layout's variables. Collective;
    /// ranks may have no rows.
    void write_volume(std::size_t variable, std::size_t time, std::size_t level,
                      View2<const double> values, std::ptrdiff_t x_start);

    /// All fields so far reach the disk. Nothing but their numbers has changed in the file
    /// since it was created, so it can be opened again after any end. Collective.
    void flush();
    /// From now on what is not committed stays for a run that goes on. Not collective.
    void leave_for_later() { left_ = true; }

    /// The rest of the file, flushed, renamed. Collective; only rank 0's arguments are written.
    void commit(const std::vector<VariableGroup>& groups, const std::vector<Attribute>& attributes);

private:
    void create_surface() const;
    void open_shared();
    void close_shared();
    void refuse_if_full(double needed_B) const;

    std::filesystem::path path_, part_;
    Comm team_;
    SurfaceLayout surface_;
    VolumeLayout volume_;
    h5::Id shared_file_, shared_field_;
    std::vector<h5::Id> shared_volumes_; // one a variable
    std::vector<double> turned_;         // a plane of the volume with x contiguous
    bool is_shared_ = false;             // shared_file_ is open
    bool committed_ = false, left_ = false;
};

enum class KeepsVolume { no, yes };

/// Why `<path>.part` cannot be gone on with, in words that follow its name; empty when it has these
/// surface fields, and a volume where one is kept. Not collective.
std::string trouble_with_part(const std::filesystem::path& path, const SurfaceLayout& surface,
                              KeepsVolume volume = KeepsVolume::no);

} // namespace shearwake
