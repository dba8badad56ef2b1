// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/stepping/step_state.hpp"

#include <array>
#include <vector>

namespace shearwake::spectral {

/// Computes -sigma_zz at the depths of a case's receptors for each frame: the zz component of the
/// stress of TensorVolumes, evaluated exactly at these depths. It is linear in the displacement one
/// step before, at and after the frame. Each wave vector contributes sums over the element that
/// contains the depth, followed by one transform per depth. If the medium varies laterally within
/// that element, one transform per node (lambda div u) and two more (mu, viscosity) are needed, and
/// twelve where surfaces of bodies cross cells, since the stress across them depends on all strains
/// and their rates. At an element boundary the result is the mean of both sides. The
/// forces at the markers of rigid bodies make it inaccurate near them (receptors_near_bodies()).
class ReceptorStress {
public:
    /// The pencils of the displacement at two consecutive steps, row by row.
    struct Steps {
        const Block *before, *now;
    };

    /// For these depths; allocates memory only if there are any. Throws CaseFailure on all ranks
    /// together. Collective.
    ReceptorStress(const Case& c, std::vector<double> depths_m, const DepthMesh& mesh,
                   const fft::SlabTransform& slabs, double step_s, const Comm& team);

    /// Whether there are any depths.
    bool wanted() const { return !depths_m_.empty(); }
    /// Saves what the next step overwrites; to be called with the displacement `before` the step
    /// that ends at a frame. Not collective.
    void remember(const Block* before);
    /// Passes the stress at `frame` to the observer, for the displacement at the frame and after
    /// the next step. Collective.
    void emit(const Steps& steps, std::ptrdiff_t frame, engines::Observer& observer);
    double allocated_B() const;
    /// Number of planes that are transformed per frame, as far as it follows from the case.
    static double planes(const Case& c, const DepthMesh& mesh);

private:
    /// One plane: a weighted sum over the nodes of an element, multiplied by a modulus of each
    /// cell.
    struct Part {
        std::size_t depth;
        std::ptrdiff_t first;                       // first level of the element
        std::array<std::vector<double>, 3> weights; // one step before, at and after the frame:
                                                    // for W at the nodes, then for -k U
        std::vector<double> factors;                // per cell; empty: 1
    };
    /// The cells at a depth within one element that surfaces of bodies cross on any rank.
    struct Surfaces {
        /// The moduli are those by which shear across the surface meets less, times -share.
        struct Cell {
            std::ptrdiff_t at; // in the plane
            Vec3 normal;
            double mu, viscosity;
        };
        std::size_t depth;
        std::ptrdiff_t first;             // first level of the element
        std::vector<double> value, slope; // weights of the nodes
        std::vector<Cell> cells;
        fft::AlignedVector<Block> motion_before; // motion at the depth one step before the frame
    };
    void add_parts(std::size_t depth, double depth_m, std::size_t element, double share);
    void add_motion(const Surfaces& surfaces, double scale, const Block* pencil,
                    Block* motion) const;
    void add_across(Surfaces& surfaces, const Steps& steps);
    void add(const Part& part, std::size_t time, const Block& k, const Block* pencil,
             Block* value) const;
    /// Calls use(row, block, pencil offset, saved contribution) for each pencil.
    template <class Use>
    void each_pencil(const Part& part, Use use);

    const Case& case_;
    DepthMesh mesh_;
    const fft::SlabTransform& slabs_;
    double step_s_;
    WaveVectors vectors_;
    std::vector<double> depths_m_;
    std::ptrdiff_t levels_; // number of moving levels
    std::vector<Part> parts_;
    fft::AlignedVector<Block> before_; // contribution of the step before the frame, for each part
    fft::AlignedVector<double> plane_, compression_;
    StrainTransfer strains_; // at the depth of surfaces
    std::vector<Surfaces> surfaces_;
    fft::AlignedVector<double> strain_; // planes of six components; empty without surfaces
};

} // namespace shearwake::spectral
