#pragma once

#include "engines/engine.hpp"
#include "engines/spectral/stepper.hpp"
#include "model/material_field.hpp"

namespace shearwake {

/// Strain and stress of volume snapshots, element by element: memory for a few dozen planes and one
/// displacement. At the time of a snapshot,
///     strain = (grad u + grad u^T) / 2,
///     stress = lambda div(u + 0.26 (u+ - 2u + u-)) + 2 mu strain + 2 viscosity (strain+ - strain-)
///              / (2 dt),
/// u+ and u- a step later and earlier. lambda div u alone would ring: compressional waves are far
/// too fast for the step and alternate in it; the mean is what balances the load in the scheme. And
/// it would alternate from node to node where a body's face cuts an element; so of its polynomial
/// over depth the two highest degrees are left out, as in P_N - P_(N-2) elements (Maday and Patera
/// 1989). Materials are those that the engine computes with. Where elements meet: the mean of both.
class TensorVolumes {
public:
    /// Collective. Holds no memory where the case keeps neither.
    TensorVolumes(const Case& c, const DepthMesh& mesh, const SlabTransform& slabs, double step_s,
                  const Comm& team);

    bool wanted() const { return wanted_; }
    /// Before the step that follows a snapshot: what that step forgets. Not collective.
    void remember(const Stepper& stepper);
    /// After that step. Collective.
    void give(const Stepper& stepper, std::size_t snapshot, Observer& observer);

private:
    struct Steps {
        const Lanes *earlier, *now, *later;
    };
    struct Materials {
        Material layer;
        std::vector<Material> cells; // none: the layer's everywhere
        const Material& operator[](std::ptrdiff_t cell) const {
            return cells.empty() ? layer : cells[static_cast<std::size_t>(cell)];
        }
    };
    Steps steps(const Stepper& stepper, std::ptrdiff_t pencil) const;
    Materials materials_at(const StrainPoint& point) const;
    void for_each_cell(const auto& f) const;
    void find_pressure(const Stepper& stepper, std::size_t element);
    void find_strain(const Stepper& stepper, const StrainPoint& point);
    /// What was found at a node, times `share`, to strain_ and stress_.
    void add(const StrainPoint& point, double share);
    void give_level(std::size_t snapshot, std::size_t level, Observer& observer);
    double* plane(AlignedVector<double>& planes, std::ptrdiff_t number) const;
    double* line(AlignedVector<double>& planes, std::ptrdiff_t number, std::ptrdiff_t row) const;

    const Case& case_;
    DepthMesh mesh_;
    const SlabTransform& slabs_;
    double step_s_;
    Comm team_;
    WaveVectors vectors_;
    bool wanted_;
    std::vector<double> smoothing_;          // of an element's nodes
    AlignedVector<double> now_, rate_;       // strain at a node: planes of six components
    AlignedVector<double> strain_, stress_;  // what becomes of them
    AlignedVector<double> pressure_;         // a plane for each node of an element
    AlignedVector<double> earlier_, pencil_; // displacement; of one pencil
};

} // namespace shearwake
