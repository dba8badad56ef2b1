// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/material.hpp"

#include <algorithm>
#include <limits>

namespace shearwake::pstd {
namespace {

constexpr double none = std::numeric_limits<double>::infinity();

Node next(Node node, std::size_t axis) {
    ++node[axis];
    return node;
}

} // namespace

double density_between(const Grid& grid, const MaterialOfNode& material, Node node,
                       std::size_t axis) {
    const NodeMaterial here = material(node);
    if (node[axis] + 1 == grid.points[axis]) return here.density_kg_m3;
    const NodeMaterial there = material(next(node, axis));
    const auto mass = [&](const NodeMaterial& m) {
        return m.empty && here.empty != there.empty ? 0.0 : m.density_kg_m3;
    };
    return 0.5 * (mass(here) + mass(there));
}

double harmonic_between(const Grid& grid, const std::function<double(Node)>& value, Node node,
                        std::size_t axis_a, std::size_t axis_b) {
    const double here = value(node);
    double sum = 0.0;
    bool uniform = true, edge = false;
    for (const bool on_a : {false, true}) {
        for (const bool on_b : {false, true}) {
            Node n = node;
            if (on_a && grid.points[axis_a] > 1) ++n[axis_a];
            if (on_b && grid.points[axis_b] > 1) ++n[axis_b];
            if (n[axis_a] == grid.points[axis_a] || n[axis_b] == grid.points[axis_b]) {
                edge = true;
                continue;
            }
            const double there = value(n);
            if (there == 0.0) return 0.0;
            uniform = uniform && there == here;
            sum += 1.0 / there;
        }
    }
    return uniform || edge ? here : 4.0 / sum; // exact for uniform values
}

template <class Real>
Coefficient<Real>::Coefficient(const Slabs& slabs, const Comm& team,
                               const std::function<double(Node)>& value)
    : pitch_(slabs.pitch), ny_(slabs.ny()), last_x_(slabs.nx() - 1 - slabs.x_start()) {
    const std::ptrdiff_t nz = slabs.nz();
    fft::AlignedVector<Real> all(static_cast<std::size_t>(slabs.reals()), Real(0));
    // Minimum and maximum for each depth in four families of rows: on the upper edge in x or not,
    // and in y or not. Values are negated, so that one maximum over the ranks yields both.
    std::vector<double> range(static_cast<std::size_t>(8 * nz), -none);
    for (std::ptrdiff_t x = 0; x < slabs.x_count(); ++x) {
        for (std::ptrdiff_t y = 0; y < ny_; ++y) {
            const std::ptrdiff_t family = (x == last_x_ ? 1 : 0) + (y == ny_ - 1 ? 2 : 0);
            for (std::ptrdiff_t z = 0; z < nz; ++z) {
                const Node node{slabs.x_start() + x, y, z};
                const double v = value(node);
                all[static_cast<std::size_t>(slabs.offset(node))] = static_cast<Real>(v);
                double& high = range[static_cast<std::size_t>(2 * (family * nz + z))];
                double& low = range[static_cast<std::size_t>(2 * (family * nz + z) + 1)];
                high = std::max(high, v);
                low = std::max(low, -v);
            }
        }
    }
    team.max(std::span<double>(range));
    for (std::size_t i = 0; i < range.size(); i += 2)
        lateral_ = lateral_ || (range[i] > -none && range[i] != -range[i + 1]);
    if (lateral_) {
        values_ = std::move(all);
        return;
    }
    values_.assign(static_cast<std::size_t>(4 * pitch_), Real(0));
    for (std::ptrdiff_t family = 0; family < 4; ++family)
        for (std::ptrdiff_t z = 0; z < nz; ++z)
            if (const double v = range[static_cast<std::size_t>(2 * (family * nz + z))]; v > -none)
                values_[static_cast<std::size_t>(family * pitch_ + z)] = static_cast<Real>(v);
}

template class Coefficient<double>;
template class Coefficient<float>;

} // namespace shearwake::pstd
