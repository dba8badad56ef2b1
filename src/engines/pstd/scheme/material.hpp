// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/grid.hpp"
#include "fft/aligned.hpp"
#include "parallel/comm.hpp"

#include <functional>

namespace shearwake::pstd {

/// Material of a node; c_s = 0 for a fluid. Coefficients of the Kelvin-Voigt law
///     sigma += chi d(e_kk)/dt delta_ij + 2 eta d(e_ij)/dt.
struct NodeMaterial {
    double density_kg_m3 = 0.0, c_p_m_s = 0.0, c_s_m_s = 0.0;
    double chi_Pa_s = 0.0, eta_Pa_s = 0.0;
    /// An empty node has no stress except that of a source. The density is used for velocity points
    /// between empty nodes; velocity points between an empty node and a medium have half a cell of
    /// that medium.
    bool empty = false;
    double mu_Pa() const { return density_kg_m3 * c_s_m_s * c_s_m_s; }
    double lambda_Pa() const { return density_kg_m3 * c_p_m_s * c_p_m_s - 2.0 * mu_Pa(); }
    bool operator==(const NodeMaterial&) const = default;
};
using MaterialOfNode = std::function<NodeMaterial(Node)>;

/// Values at the points of the staggered grid, by the storage index of their field. Empty functions
/// stand for means of the adjacent nodes.
struct StaggeredMaterial {
    using Value = std::function<double(Node)>;
    std::array<Value, 3> density_kg_m3;   // at ux, uy, uz
    std::array<Value, 3> mu_Pa, eta_Pa_s; // at sxy, sxz, syz
};

/// A coefficient at every point of a rank's slab. If it does not vary along x and y it is stored
/// once, with separate rows for the planes at the upper edges, whose averages differ.
template <class Real>
class Coefficient {
public:
    /// Evaluates `value` at the global node with the storage index of each point. Collective.
    Coefficient(const Slabs& slabs, const Comm& team, const std::function<double(Node)>& value);
    Coefficient() = default;

    /// The row (x, y), where x is relative to the slab.
    const Real* row(std::ptrdiff_t x, std::ptrdiff_t y) const {
        if (!lateral_)
            return values_.data() + pitch_ * ((x == last_x_ ? 1 : 0) + (y == ny_ - 1 ? 2 : 0));
        return values_.data() + pitch_ * (x * ny_ + y);
    }
    bool varies_laterally() const { return lateral_; }
    /// All rows, or four of them.
    const fft::AlignedVector<Real>& values() const { return values_; }

private:
    fft::AlignedVector<Real> values_;
    std::ptrdiff_t pitch_ = 0, ny_ = 0, last_x_ = 0;
    bool lateral_ = false;
};

/// Density at the velocity points (arithmetic mean of two nodes along `axis`; an empty node next to
/// a medium counts as 0), and mu or eta at the shear points (harmonic mean of the four surrounding
/// nodes, 0 if any of them is 0). At the upper edge of the grid there are no neighbours: the value
/// of the node itself is used as in k-Wave, or 0 if a neighbour within the grid is 0. Along an axis
/// with a single point the node is its own neighbour. Not collective.
double density_between(const Grid& grid, const MaterialOfNode& material, Node node,
                       std::size_t axis);
double harmonic_between(const Grid& grid, const std::function<double(Node)>& value, Node node,
                        std::size_t axis_a, std::size_t axis_b);

} // namespace shearwake::pstd
