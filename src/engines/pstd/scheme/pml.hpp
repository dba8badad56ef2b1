// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/kernels/update.hpp"
#include "engines/pstd/scheme/grid.hpp"

namespace shearwake::pstd {

/// Factors of the layer along one axis, for fields on nodes and for those half a cell on: `main`
/// for the part that this axis' derivative feeds, `other` for the other parts (ratio times the
/// strength). With s = strength c_ref/d [depth/points]^4 the factor is exp(-s dt/2), 1 outside.
struct PmlProfile {
    std::vector<double> main, other;
    bool operator==(const PmlProfile&) const = default;
};
enum class PmlPlaces { nodes, half_a_cell_on };

/// The split-field multi-axial perfectly matched layer inside the grid. Strength 0: none.
struct PmlOptions {
    std::array<std::ptrdiff_t, 3> points = {10, 10, 10}; // on each side of an axis
    std::array<double, 3> strength_1 = {2.0, 2.0, 2.0};  // Np per grid point, k-Wave's PMLAlpha
    double multi_axial_ratio_1 = 0.1;
    double reference_speed_m_s = 0.0; // 0: the largest c_p of the grid
    /// Specified factors of an axis, at its PmlPlaces, in place of those that follow from the
    /// numbers above. The layer is where one of them is not 1. Empty: none are specified.
    std::array<std::array<PmlProfile, 2>, 3> given = {};
    bool operator==(const PmlOptions&) const = default;
};

PmlProfile pml_profile(const Grid& grid, const PmlOptions& options, std::size_t axis,
                       PmlPlaces places, double reference_speed_m_s);

/// Where a field's parts are kept on a rank: in the layer, and, all of them, at nodes that are
/// asked for.
class SplitRuns {
public:
    /// Runs take up multiples of this many values: whole lines of the cache in either precision.
    static constexpr std::ptrdiff_t line = 16;

    SplitRuns() = default;
    /// `nodes` of this rank whose values keep their parts outside the layer as well.
    SplitRuns(const Slabs& slabs, const PmlOptions& options, const Parts& parts,
              const std::vector<Node>& nodes);

    /// Of the row (x, y), x counted from the slab's first; ascending, apart from each other.
    struct Row {
        const SplitRun *first, *last;
        const SplitRun* begin() const { return first; }
        const SplitRun* end() const { return last; }
    };
    Row row(std::ptrdiff_t row) const {
        const auto at = static_cast<std::size_t>(row);
        return {runs_.data() + starts_[at], runs_.data() + starts_[at + 1]};
    }
    /// All runs, and the number of the first of each row.
    const std::vector<SplitRun>& runs() const { return runs_; }
    const std::vector<std::size_t>& starts() const { return starts_; }
    /// The run that a value is in, or none.
    const SplitRun* run_at(std::ptrdiff_t row, std::ptrdiff_t z) const {
        for (const SplitRun& run : this->row(row))
            if (z >= run.begin && z < run.end) return &run;
        return nullptr;
    }
    /// Values of the first and of the second array of parts.
    std::ptrdiff_t size(std::size_t part) const { return sizes_[part]; }

private:
    void add(SplitRun run, const Parts& parts);

    std::vector<std::size_t> starts_ = {0};
    std::vector<SplitRun> runs_;
    std::array<std::ptrdiff_t, 2> sizes_ = {};
};

/// What SplitRuns without further nodes will store: values of all parts, and the memory of the
/// runs.
struct SplitSizes {
    double values = 0.0, runs_B = 0.0;
};
SplitSizes split_sizes(const Slabs& slabs, const PmlOptions& options, const Parts& parts);

} // namespace shearwake::pstd
