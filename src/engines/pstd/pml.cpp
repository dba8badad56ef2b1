#include "engines/pstd/pml.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::pstd {
namespace {

bool in_layer(const Grid& grid, const PmlOptions& options, std::size_t axis, std::ptrdiff_t i) {
    if (options.strength_1[axis] == 0.0) return false;
    return i < options.points[axis] || i >= grid.points[axis] - options.points[axis];
}

} // namespace

PmlProfile pml_profile(const Grid& grid, const PmlOptions& options, std::size_t axis,
                       bool staggered, double reference_speed_m_s) {
    const std::ptrdiff_t n = grid.points[axis], layer = options.points[axis];
    const double o = staggered ? 0.5 : 0.0, length = static_cast<double>(layer);
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

SplitRuns::SplitRuns(const Slabs& slabs, const PmlOptions& options,
                     const std::vector<Node>& nodes) {
    std::vector<Node> asked = nodes;
    std::sort(asked.begin(), asked.end());
    auto next = asked.begin();
    const std::ptrdiff_t nz = slabs.nz();
    std::vector<char> split(static_cast<std::size_t>(nz));
    for (std::ptrdiff_t x = 0; x < slabs.x_count(); ++x) {
        for (std::ptrdiff_t y = 0; y < slabs.ny(); ++y) {
            const bool whole = in_layer(slabs.grid, options, 0, slabs.x_start() + x) ||
                               in_layer(slabs.grid, options, 1, y);
            for (std::ptrdiff_t z = 0; z < nz; ++z)
                split[static_cast<std::size_t>(z)] =
                    whole || in_layer(slabs.grid, options, 2, z) ? 1 : 0;
            for (; next != asked.end() && (*next)[0] == slabs.x_start() + x && (*next)[1] == y;
                 ++next)
                split[static_cast<std::size_t>((*next)[2])] = 1;
            for (auto from = std::find(split.begin(), split.end(), 1); from != split.end();) {
                const auto to = std::find(from, split.end(), 0);
                runs_.push_back({from - split.begin(), to - split.begin(), size_});
                size_ += (to - from + line - 1) / line * line;
                from = std::find(to, split.end(), 1);
            }
            starts_.push_back(runs_.size());
        }
    }
}

} // namespace shearwake::pstd
