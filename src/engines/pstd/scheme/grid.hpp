// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace shearwake::pstd {

/// nx x ny x nz nodes of a periodic box (any even or odd numbers), and the time step.
struct Grid {
    std::array<std::ptrdiff_t, 3> points = {};
    std::array<double, 3> spacing_m = {};
    double dt_s = 0.0;
    /// A single node along x, with the rules of k-Wave's two-dimensional code for pressure and
    /// sources.
    bool is_plane = false;
    /// Of a plane: nothing moves along x, so that ux, sxy and sxz remain 0 and are not computed.
    bool moves_in_plane = false;
    bool operator==(const Grid&) const = default;
};

/// The axis of k-Wave that is this axis of the scheme. The axes x, y and z of a plane are z, x and
/// y of k-Wave, so that its rows are as long as those of a box.
inline std::size_t kwave_axis(const Grid& grid, std::size_t axis) {
    return grid.is_plane ? (axis + 2) % 3 : axis;
}

/// Storage indices of a node along x, y, z.
using Node = std::array<std::ptrdiff_t, 3>;

/// Particle velocities [m/s] and stresses [Pa].
enum class Field { ux, uy, uz, sxx, syy, szz, sxy, sxz, syz };
constexpr std::size_t field_count = 9;

constexpr std::size_t index_of(Field field) {
    return static_cast<std::size_t>(field);
}
constexpr bool is_velocity(Field field) {
    return index_of(field) < 3;
}

/// Whether a field is staggered by half a cell along an axis: ux is at (i+1/2, j, k), sxy at
/// (i+1/2, j+1/2, k), and so on; normal stresses are at the nodes.
constexpr bool is_staggered(Field field, std::size_t axis) {
    constexpr bool staggered[field_count][3] = {
        {true, false, false},  {false, true, false},  {false, false, true},
        {false, false, false}, {false, false, false}, {false, false, false},
        {true, true, false},   {true, false, true},   {false, true, true}};
    return staggered[index_of(field)][axis];
}

/// The axes whose derivatives contribute to a field, one split part each. The first part is not
/// stored; it is the total minus the other parts.
struct Parts {
    std::size_t count = 3;
    std::array<std::size_t, 3> axes = {};
};
constexpr Parts parts_of(Field field) {
    constexpr Parts parts[field_count] = {{3, {0, 1, 2}}, {3, {1, 0, 2}}, {3, {2, 0, 1}},
                                          {3, {0, 1, 2}}, {3, {1, 0, 2}}, {3, {2, 0, 1}},
                                          {2, {0, 1, 1}}, {2, {0, 2, 2}}, {2, {1, 2, 2}}};
    return parts[index_of(field)];
}

/// Distribution of the box over `ranks`: slabs of x, and slabs of y for complete x-lines. Rows of z
/// are contiguous and begin `pitch` values apart, a multiple of the cache line.
struct Slabs {
    Grid grid;
    int ranks = 1, rank = 0;
    std::ptrdiff_t pitch = 0;

    std::ptrdiff_t nx() const { return grid.points[0]; }
    std::ptrdiff_t ny() const { return grid.points[1]; }
    std::ptrdiff_t nz() const { return grid.points[2]; }
    std::ptrdiff_t x_start(int of) const { return nx() * of / ranks; }
    std::ptrdiff_t y_start(int of) const { return ny() * of / ranks; }
    std::ptrdiff_t x_count(int of) const { return x_start(of + 1) - x_start(of); }
    std::ptrdiff_t y_count(int of) const { return y_start(of + 1) - y_start(of); }
    std::ptrdiff_t x_start() const { return x_start(rank); }
    std::ptrdiff_t x_count() const { return x_count(rank); }
    std::ptrdiff_t rows() const { return x_count() * ny(); } // this rank's rows of z
    std::ptrdiff_t reals() const { return rows() * pitch; }
    bool has(std::ptrdiff_t x) const { return x >= x_start() && x < x_start() + x_count(); }
    /// Index of a global node in this rank's arrays.
    std::ptrdiff_t offset(Node n) const {
        return ((n[0] - x_start()) * ny() + n[1]) * pitch + n[2];
    }
};

inline Slabs slabs_of(const Grid& grid, int ranks, int rank) {
    const std::ptrdiff_t line = 16; // reals: 64 bytes even in single precision
    return {grid, ranks, rank, (grid.points[2] + line - 1) / line * line};
}

} // namespace shearwake::pstd
