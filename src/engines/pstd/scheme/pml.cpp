// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/pml.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace shearwake::pstd {
namespace {

bool in_layer(const Grid& grid, const PmlOptions& options, std::size_t axis, std::ptrdiff_t i) {
    const auto& given = options.given[axis];
    if (!given[0].main.empty()) {
        const auto at = static_cast<std::size_t>(i);
        return std::any_of(given.begin(), given.end(), [&](const PmlProfile& p) {
            return p.main[at] != 1.0 || p.other[at] != 1.0;
        });
    }
    if (options.strength_1[axis] == 0.0) return false;
    return i < options.points[axis] || i >= grid.points[axis] - options.points[axis];
}

} // namespace

PmlProfile pml_profile(const Grid& grid, const PmlOptions& options, std::size_t axis,
                       PmlPlaces places, double reference_speed_m_s) {
    if (const PmlProfile& given = options.given[axis][static_cast<std::size_t>(places)];
        !given.main.empty())
        return given;
    const std::ptrdiff_t n = grid.points[axis], layer = options.points[axis];
    const double o = places == PmlPlaces::nodes ? 0.0 : 0.5, length = static_cast<double>(layer);
    PmlProfile profile{std::vector<double>(static_cast<std::size_t>(n), 1.0),
                       std::vector<double>(static_cast<std::size_t>(n), 1.0)};
    for (std::ptrdiff_t i = 0; i < n; ++i) {
        if (!in_layer(grid, options, axis, i)) continue;
        const double depth = i < layer ? static_cast<double>(layer - i) - o
                                       : static_cast<double>(i - (n - layer) + 1) + o;
        const double s = options.strength_1[axis] * reference_speed_m_s / grid.spacing_m[axis] *
                         std::pow(depth / length, 4);
        profile.main[static_cast<std::size_t>(i)] = std::exp(-0.5 * s * grid.dt_s);
        profile.other[static_cast<std::size_t>(i)] =
            std::exp(-0.5 * options.multi_axial_ratio_1 * s * grid.dt_s);
    }
    return profile;
}

namespace {

/// What a value keeps: the part of one axis (0, 1, 2), nothing, or all.
constexpr int nothing = 3, all = -1;

/// Runs without their places.
std::vector<SplitRun> runs_of(const std::vector<int>& row) {
    std::vector<SplitRun> found;
    for (auto from = row.begin(); from != row.end();) {
        const auto to = std::find_if(from, row.end(), [&](int k) { return k != *from; });
        if (*from != nothing) found.push_back({from - row.begin(), to - row.begin(), 0, 0, *from});
        from = to;
    }
    return found;
}

/// What is stored of the nodes of a row, which follows from whether its x and its y are in a layer.
class RowKinds {
public:
    RowKinds(const Slabs& slabs, const PmlOptions& options) : slabs_(slabs), options_(options) {
        const std::ptrdiff_t nz = slabs.nz();
        // A short rest between the layers of z goes with them: its factors are 1, and whole rows
        // are faster than three short pieces.
        std::ptrdiff_t rest = 0;
        for (std::ptrdiff_t z = 0; z < nz; ++z)
            rest += in_layer(slabs.grid, options, 2, z) ? 0 : 1;
        const bool full_rows = rest < nz && rest < 32;
        for (const bool in_x : {false, true}) {
            for (const bool in_y : {false, true}) {
                const int between = in_x && in_y ? all : in_x ? 0 : in_y ? 1 : nothing;
                std::vector<int>& row = rows[in_x + 2 * in_y];
                for (std::ptrdiff_t z = 0; z < nz; ++z) {
                    const bool in_z = full_rows || in_layer(slabs.grid, options, 2, z);
                    row.push_back(!in_z ? between : in_x || in_y ? all : 2);
                }
            }
        }
        std::transform(rows.begin(), rows.end(), runs.begin(), runs_of);
    }
    std::size_t row_kind(std::ptrdiff_t row) const {
        return in_layer(slabs_.grid, options_, 0, slabs_.x_start() + row / slabs_.ny()) +
               2 * in_layer(slabs_.grid, options_, 1, row % slabs_.ny());
    }
    /// The number of rows of each kind.
    std::array<double, 4> counts() const {
        double in_x = 0.0, in_y = 0.0;
        for (std::ptrdiff_t x = 0; x < slabs_.x_count(); ++x)
            in_x += in_layer(slabs_.grid, options_, 0, slabs_.x_start() + x) ? 1.0 : 0.0;
        for (std::ptrdiff_t y = 0; y < slabs_.ny(); ++y)
            in_y += in_layer(slabs_.grid, options_, 1, y) ? 1.0 : 0.0;
        const double out_x = static_cast<double>(slabs_.x_count()) - in_x,
                     out_y = static_cast<double>(slabs_.ny()) - in_y;
        return {out_x * out_y, in_x * out_y, out_x * in_y, in_x * in_y};
    }
    std::array<std::vector<int>, 4> rows;
    std::array<std::vector<SplitRun>, 4> runs;

private:
    const Slabs& slabs_;
    const PmlOptions& options_;
};

/// How many values a run takes up in the first and in the second array of parts.
std::array<std::ptrdiff_t, 2> sizes_of(const SplitRun& run, const Parts& parts) {
    constexpr std::ptrdiff_t line = SplitRuns::line;
    const auto of_face = static_cast<std::size_t>(std::max(run.face, 0));
    const auto last = parts.axes.begin() + static_cast<std::ptrdiff_t>(parts.count);
    const std::ptrdiff_t values = (run.end - run.begin + line - 1) / line * line;
    const bool first = run.face == all || std::find(parts.axes.begin(), last, of_face) != last;
    return {first ? values : 0, run.face == all && parts.count == 3 ? values : 0};
}

} // namespace

void SplitRuns::add(SplitRun run, const Parts& parts) {
    const auto values = sizes_of(run, parts);
    runs_.push_back({run.begin, run.end, sizes_[0], sizes_[1], run.face});
    sizes_[0] += values[0];
    sizes_[1] += values[1];
}

SplitRuns::SplitRuns(const Slabs& slabs, const PmlOptions& options, const Parts& parts,
                     const std::vector<Node>& nodes) {
    std::vector<Node> asked = nodes;
    std::sort(asked.begin(), asked.end());
    auto next = asked.begin();
    const RowKinds kinds(slabs, options);
    const std::ptrdiff_t count = slabs.x_count() * slabs.ny();
    std::size_t total = 0;
    for (std::ptrdiff_t row = 0; row < count; ++row)
        total += kinds.runs[kinds.row_kind(row)].size();
    runs_.reserve(total);
    starts_.reserve(static_cast<std::size_t>(count) + 1);
    for (std::ptrdiff_t row = 0; row < count; ++row) {
        const auto is_here = [&] {
            return next != asked.end() && (*next)[0] == slabs.x_start() + row / slabs.ny() &&
                   (*next)[1] == row % slabs.ny();
        };
        std::vector<SplitRun> own;
        if (is_here()) {
            std::vector<int> row_kinds = kinds.rows[kinds.row_kind(row)];
            for (; is_here(); ++next)
                row_kinds[static_cast<std::size_t>((*next)[2])] = all;
            own = runs_of(row_kinds);
        }
        for (const SplitRun& run : own.empty() ? kinds.runs[kinds.row_kind(row)] : own)
            add(run, parts);
        starts_.push_back(runs_.size());
    }
}

SplitSizes split_sizes(const Slabs& slabs, const PmlOptions& options, const Parts& parts) {
    const RowKinds kinds(slabs, options);
    const std::array<double, 4> counts = kinds.counts();
    SplitSizes sizes;
    for (std::size_t kind = 0; kind < counts.size(); ++kind) {
        sizes.runs_B += counts[kind] * sizeof(std::size_t); // the start of a row
        for (const SplitRun& run : kinds.runs[kind]) {
            const auto values = sizes_of(run, parts);
            sizes.runs_B += counts[kind] * sizeof(SplitRun);
            sizes.values += counts[kind] * static_cast<double>(values[0] + values[1]);
        }
    }
    return sizes;
}

} // namespace shearwake::pstd
