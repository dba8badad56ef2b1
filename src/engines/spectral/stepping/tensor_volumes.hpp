// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/stepping/step_state.hpp"
#include "problem/medium/material_field.hpp"

namespace shearwake::spectral {

/// Strain and stress of volume snapshots, computed element by element with memory for a few dozen
/// planes and one displacement. At the time of a snapshot,
///     strain = (grad u + grad u^T) / 2,
///     stress = lambda div(u + 0.26 (u+ - 2u + u-)) + 2 mu strain + 2 viscosity (strain+ - strain-)
///              / (2 dt),
/// where u+ and u- are one step later and earlier. lambda div u alone would oscillate:
/// compressional waves are far too fast for the step and alternate from step to step. The average
/// over three steps is the quantity that balances the load in the scheme. It would also alternate
/// from node to node where the face of a body cuts an element. Therefore the two highest degrees of
/// its polynomial over depth are removed, as in P_N - P_(N-2) elements (Maday and Patera 1989). The
/// materials are those of the computation (with capped stiffness). At an element boundary the
/// result is the mean of both sides. The forces at the markers of rigid bodies make it inaccurate
/// near them.
class TensorVolumes {
public:
    /// Allocates memory only if the case records strain or stress. Throws CaseFailure on all ranks
    /// together. Collective.
    TensorVolumes(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                  double step_s, const Comm& team);

    /// Whether the case records strain or stress.
    bool wanted() const { return wanted_; }
    /// Saves what the next step overwrites; to be called before the step that follows a snapshot.
    /// Not collective.
    void remember(const StepState& state);
    /// Passes the planes of the snapshot to the observer; to be called after that step. Strain and
    /// stress are zero inside rigid bodies. Collective.
    void emit(const StepState& state, const InsideBodies& inside, std::size_t snapshot,
              engines::Observer& observer);
    double allocated_B() const;

private:
    struct Steps {
        const Block *earlier, *now, *later;
    };
    struct Materials {
        CellMaterial layer;
        std::vector<CellMaterial> cells; // empty: those of the layer everywhere
        const CellMaterial& operator[](std::ptrdiff_t cell) const {
            return cells.empty() ? layer : cells[static_cast<std::size_t>(cell)];
        }
    };
    Steps steps(const StepState& state, std::ptrdiff_t pencil) const;
    static void add_mean(const Steps& u, std::ptrdiff_t i, const auto& weight, Block& to);
    Materials materials_at(const StrainPoint& point) const;
    void for_each_cell(const auto& f) const;
    void find_pressure(const StepState& state, std::size_t element);
    void find_strain(const StepState& state, const StrainPoint& point);
    /// Adds the results at a node times `share` to strain_ and stress_.
    void add(const StrainPoint& point, double share);
    void emit_level(const InsideBodies& inside, std::size_t snapshot, std::size_t level,
                    engines::Observer& observer);
    double* plane(fft::AlignedVector<double>& planes, std::ptrdiff_t number) const;
    double* line(fft::AlignedVector<double>& planes, std::ptrdiff_t number,
                 std::ptrdiff_t row) const;

    const Case& case_;
    DepthMesh mesh_;
    const fft::SlabTransform& slabs_;
    double step_s_;
    Comm team_;
    WaveVectors vectors_;
    bool wanted_;
    std::vector<double> smoothing_;              // of the nodal values of an element
    fft::AlignedVector<double> now_, rate_;      // strain at a node: planes of six components
    fft::AlignedVector<double> strain_, stress_; // accumulated results
    fft::AlignedVector<double> pressure_;        // one plane per node of an element
    fft::AlignedVector<Block> earlier_, pencil_; // displacement one step before; of one pencil
};

} // namespace shearwake::spectral
