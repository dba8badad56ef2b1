#pragma once

#include "base/view.hpp"
#include "io/h5.hpp"
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

/// A case file in the making: `<path>.part` until it is committed, then whole and renamed; removed
/// when it is not. xarray opens the result as it is: dimension scales, units and long names on
/// every variable.
class CaseFileWriter {
public:
    /// Collective. Rank 0 creates the file, then all ranks open it through MPI if there are surface
    /// fields to come. Throws CaseFailure on all ranks (no space, no permission).
    CaseFileWriter(const std::filesystem::path& path, const Comm& team, SurfaceLayout surface);
    /// Not collective: rank 0 removes what was not committed.
    ~CaseFileWriter();
    CaseFileWriter(const CaseFileWriter&) = delete;
    CaseFileWriter& operator=(const CaseFileWriter&) = delete;

    /// This rank's rows x_start ... of one surface field. Collective; ranks may have no rows.
    void write_surface(std::size_t time, std::size_t depth, View2<const double> u_z_m,
                       std::ptrdiff_t x_start);

    /// The rest of the file, flushed, renamed. Collective; only rank 0's arguments are written.
    void commit(const std::vector<VariableGroup>& groups, const std::vector<Attribute>& attributes);

private:
    void create_surface() const;

    std::filesystem::path path_, part_;
    Comm team_;
    SurfaceLayout surface_;
    h5::Id shared_file_, shared_field_;
    bool committed_ = false;
};

} // namespace shearwake
