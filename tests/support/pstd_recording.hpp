#pragma once

#include "engines/pstd/stepper.hpp"

namespace shearwake::pstd {

/// Nodes low ... low + counts - 1 along each axis: a plane, a volume, a line, a point.
struct Box {
    Node low = {}, counts = {1, 1, 1};
    std::size_t size() const { return static_cast<std::size_t>(counts[0] * counts[1] * counts[2]); }
};

/// A field's totals at its own staggered places, at the nodes' storage indices: of a list of nodes,
/// and of a box, [x][y][z]. On every rank. Collective.
template <class Real>
std::vector<double> values_at(const Stepper<Real>& stepper, Field field,
                              std::span<const Node> nodes, const Comm& team) {
    std::vector<double> values;
    for (const Node& n : nodes)
        values.push_back(stepper.slabs().has(n[0])
                             ? static_cast<double>(stepper.total(
                                   field)[static_cast<std::size_t>(stepper.slabs().offset(n))])
                             : 0.0);
    team.sum(std::span<double>(values));
    return values;
}

template <class Real>
std::vector<double> values_in(const Stepper<Real>& stepper, Field field, const Box& box,
                              const Comm& team) {
    std::vector<Node> nodes;
    for (std::ptrdiff_t x = 0; x < box.counts[0]; ++x)
        for (std::ptrdiff_t y = 0; y < box.counts[1]; ++y)
            for (std::ptrdiff_t z = 0; z < box.counts[2]; ++z)
                nodes.push_back({box.low[0] + x, box.low[1] + y, box.low[2] + z});
    return values_at<Real>(stepper, field, nodes, team);
}

} // namespace shearwake::pstd
