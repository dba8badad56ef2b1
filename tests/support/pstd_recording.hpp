// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/stepper.hpp"

namespace shearwake::pstd {

/// The nodes from low to low + counts - 1 along each axis: a volume, plane, line or point.
struct Box {
    pstd::Node low = {}, counts = {1, 1, 1};
    std::size_t size() const { return static_cast<std::size_t>(counts[0] * counts[1] * counts[2]); }
};

/// Totals of a field at its own staggered positions, identified by the indices of nodes: for a list
/// of nodes, and for a box in the order [x][y][z]. Returned on every rank. Collective.
template <class Real>
std::vector<double> values_at(const pstd::Stepper<Real>& stepper, pstd::Field field,
                              std::span<const pstd::Node> nodes, const Comm& team) {
    std::vector<double> values;
    for (const pstd::Node& n : nodes)
        values.push_back(stepper.slabs().has(n[0])
                             ? static_cast<double>(stepper.total(
                                   field)[static_cast<std::size_t>(stepper.slabs().offset(n))])
                             : 0.0);
    team.sum(std::span<double>(values));
    return values;
}

template <class Real>
std::vector<double> values_in(const pstd::Stepper<Real>& stepper, pstd::Field field, const Box& box,
                              const Comm& team) {
    std::vector<pstd::Node> nodes;
    for (std::ptrdiff_t x = 0; x < box.counts[0]; ++x)
        for (std::ptrdiff_t y = 0; y < box.counts[1]; ++y)
            for (std::ptrdiff_t z = 0; z < box.counts[2]; ++z)
                nodes.push_back({box.low[0] + x, box.low[1] + y, box.low[2] + z});
    return values_at<Real>(stepper, field, nodes, team);
}

} // namespace shearwake::pstd
