// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/rigid_bodies.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/kernels/markers.hpp"
#include "engines/spectral/lateral/moving_load.hpp"
#include "fft/aligned.hpp"
#include "parallel/comm.hpp"

#include <array>
#include <vector>

namespace shearwake::spectral {

/// The markers of all endless rigid bodies with the data for MarkerKernels. They are
/// ordered by depth. Not collective.
class SectionMarkers {
public:
    struct Marker {
        std::size_t body;
        double across_m, down_m; // from the centre of the body
        double at_m;             // across the axis, from the first point of the grid
        double depth_m;
    };
    SectionMarkers(const RigidPlan& plan, const DepthMesh& mesh, const WaveVectors& vectors);

    const std::vector<Marker>& markers() const { return markers_; }
    std::ptrdiff_t count() const { return std::ssize(markers_); }
    bool along_x() const { return along_x_; }
    double memory_B() const { return static_cast<double>(phases_.size() * sizeof(Block)); }
    /// Extent of the domain across the axis.
    double across_extent_m() const { return across_extent_m_; }
    /// Valid for the lifetime of this object.
    MarkerArrays arrays() const;
    /// Index of a marker's depth in arrays().
    std::size_t depth_of(std::size_t marker) const { return depth_of_[marker]; }

    /// Phases of the markers for a block, as MarkerKernels need them.
    const Block* phases(std::ptrdiff_t row, std::ptrdiff_t block) const {
        return phases_.data() + 2 * count() * (along_x_ ? row : block);
    }
    Block mirrored(std::ptrdiff_t row, std::ptrdiff_t block) const;

private:
    void place(const RigidPlan& plan, const DepthMesh& mesh);
    void put_phases();

    WaveVectors vectors_;
    bool along_x_ = false;
    double across_extent_m_ = 0.0, smoothing_m_ = 0.0;
    std::vector<Marker> markers_;
    std::vector<std::size_t> depth_of_;
    std::vector<MarkerDepth> depths_;
    std::vector<double> weights_;
    std::ptrdiff_t nodes_, levels_;
    fft::AlignedVector<Block> phases_; // [block or row][marker][cos, sin]
};

/// The systems G F = d of an endless body: for each wavenumber along the axis the displacement of
/// the markers due to the forces at all markers, G = J B^-1 J', real and symmetric, [marker]
/// [component]. A rank keeps the inverses of its systems.
class EndlessSystems {
public:
    explicit EndlessSystems(const SectionMarkers& markers, const WaveVectors& vectors,
                            const Comm& team);

    /// Computes all systems with B^-1 of a pencil, solve(row, block, pencil), and inverts those of
    /// this rank. Throws CaseFailure if a system is singular. Collective.
    using Solve = RigidBodies::Solve;
    void assemble(const VerticalOperator& op, const Solve& solve);

    /// Numbers of the systems of this rank: indices of ky for an axis along y, of kx for one along
    /// x. System 0 belongs to rank 0.
    const std::vector<std::ptrdiff_t>& mine() const { return mine_; }
    /// Blocks of kx whose systems belong to a rank, for an axis along x.
    std::ptrdiff_t first_block(int rank) const {
        return (rank * vectors_.blocks() + team_.size() - 1) / team_.size();
    }
    std::size_t unknowns() const {
        return static_cast<std::size_t>(markers_.count() * marker_components);
    }
    /// The inverse of a system of this rank (index into mine()), column by column.
    const double* inverse(std::size_t index) const { return inverses_[index].data(); }

private:
    /// The response of one block of wave vectors at all depths to unit forces at all depths, each
    /// [force depth][depth]: U and W due to a force on U, U and W due to a force on W, V due to one
    /// on V.
    struct Response {
        enum Kind { uu, wu, uw, ww, vv, kinds };
        fft::AlignedVector<Block> pencil;
        std::array<std::vector<Block>, kinds> of;
        std::vector<double> cosine, sine; // per marker, of one wavenumber across
    };
    void respond(const VerticalOperator& op, const Solve& solve, std::ptrdiff_t row,
                 std::ptrdiff_t block);
    void add_lane(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t lane, double* matrix);
    void assemble_rows(const VerticalOperator& op, const Solve& solve);
    void assemble_blocks(const VerticalOperator& op, const Solve& solve);

    const SectionMarkers& markers_;
    WaveVectors vectors_;
    Comm team_;
    std::vector<std::ptrdiff_t> mine_;
    std::vector<fft::AlignedVector<double>> inverses_;
    Response response_; // only during assemble()
};

/// Memory of the endless bodies on the rank that needs most, in bytes. Not collective.
double endless_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
