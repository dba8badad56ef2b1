// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/march.hpp"
#include "engines/spectral/receptor_stress.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "engines/spectral/tensor_volumes.hpp"

namespace shearwake::spectral {

/// Runs a case of the engine "spectral": u_z at the measured depths for each frame; displacement,
/// strain and stress for each snapshot; and the stress at receptors. Strain and stress need the
/// step after the frame or snapshot.
class SpectralMarch : public engines::Marching {
public:
    /// Throws CaseFailure on all ranks together. Collective.
    SpectralMarch(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                  const TimeStep& time, const Comm& team);

    std::ptrdiff_t step() const override { return stepper_.step(); }
    void advance() override;
    void give(engines::Observer& observer) override;
    void save(StateWriter& state) const override { stepper_.save(state); }
    void restore(const StateReader& state) override { stepper_.restore(state); }

    /// Depths of the levels of volumes.
    const std::vector<double>& levels_m() const { return levels_m_; }
    /// To be called after the last step: takes one more step if the strain or stress at its end is
    /// required. Collective.
    void finish(engines::Observer& observer);
    Stepper& stepper() { return stepper_; }

private:
    /// The snapshot at the end of a step, if any.
    std::optional<std::size_t> snapshot(std::ptrdiff_t step) const;
    void give_frame(std::ptrdiff_t number, engines::Observer& observer);
    void give_displacement(std::size_t snapshot, std::size_t field, engines::Observer& observer);
    void give_earlier(engines::Observer& observer);
    View2<const double> plane() const;

    const Case& case_;
    Case layers_; // and elastic bodies: those whose material the tensors need
    const fft::SlabTransform& slabs_;
    std::ptrdiff_t per_frame_;
    Stepper stepper_;
    InsideBodies inside_;
    TensorVolumes tensors_;
    ReceptorStress receptors_;
    std::vector<double> levels_m_;
    fft::AlignedVector<double> plane_;
    // Output that refers to the start of the last step: the tensors of a snapshot, the stress of a
    // frame.
    std::optional<std::size_t> remembered_snapshot_;
    std::optional<std::ptrdiff_t> remembered_frame_;
};

} // namespace shearwake::spectral
