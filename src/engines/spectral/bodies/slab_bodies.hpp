// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_systems.hpp"
#include "engines/spectral/bodies/rigid_bodies.hpp"

#include <vector>

namespace shearwake::spectral {

/// Rigid bodies as wide as the domain in x and y. Nearly incompressible tissue below and periodic
/// edges leave them no motion, so they are at rest: forces at their faces and at some depths inside
/// keep the displacement there at zero. Each wave vector is constrained by itself.
class SlabBodies {
public:
    using Solve = RigidBodies::Solve;
    SlabBodies(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors);

    bool empty() const { return depths_.empty(); }
    /// Inverts G = J B^-1 J' of this rank's wave vectors, with B^-1 of a pencil, solve(row, block,
    /// pencil). Throws CaseFailure if the slabs are too close to each other. Not collective.
    void assemble(const VerticalOperator& op, const Solve& solve);
    /// Adds the response to the forces that keep the slabs at rest to a change d of the
    /// displacement of a pencil: with `u` and `before` such that 2 u - before + scale d is zero
    /// there, otherwise such that d is. Not collective.
    void constrain(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d);
    void constrain(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d,
                   double scale, const Block* u, const Block* before);

private:
    /// The unknowns U and W, then V of all depths.
    std::ptrdiff_t size() const { return 3 * std::ssize(depths_); }
    std::ptrdiff_t inverse_size() const { return 5 * std::ssize(depths_) * std::ssize(depths_); }
    /// Calls use(weight, place of the first part in a pencil) for the nodes of a constraint.
    template <class Use>
    void each_node(std::ptrdiff_t constraint, const Use& use) const;
    void evaluate(double scale, const Block* pencil, Block* values) const;
    void respond(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d);
    void invert(const std::vector<Block>& matrix, const WaveVectors& vectors, std::ptrdiff_t block,
                Block* inverse) const;

    WaveVectors vectors_;
    std::vector<DepthWeights> depths_;
    std::ptrdiff_t levels_;
    std::vector<Block> values_, forces_;
    /// [pencil][of U and W: column][row], then those of V.
    fft::AlignedVector<Block> inverses_, pencil_;
};

/// Memory of the slabs of a case on the rank that needs most, in bytes. Not collective.
double slab_memory_B(const Case& c, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
