// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/rigid_bodies.hpp"
#include "engines/spectral/bodies/stress/grid_forces.hpp"
#include "fft/slab_transform.hpp"

#include <memory>
#include <vector>

namespace shearwake::spectral {

/// The difference between the stress close to rigid bodies and the stress that the engine computes
/// from the forces at their markers (docs/explanation/engine-spectral.md).
class StressCorrection {
public:
    /// At one point of a plane [x_count][padded_ny].
    struct Change {
        std::size_t place;
        Stress stress_Pa;
    };

    StressCorrection() = default;
    StressCorrection(const StressCorrection&) = delete;
    StressCorrection& operator=(const StressCorrection&) = delete;
    virtual ~StressCorrection() = default;
    /// Sets the forces, RigidBodies::step_forces(). Collective.
    virtual void set_forces(const std::vector<double>& step_forces) = 0;
    /// Adds the correction of sigma_zz [Pa] at a depth, times `factor`, to a plane. Not collective.
    virtual void add_zz(std::size_t depth, double factor, double* plane) const = 0;
    /// The correction at all points of a depth where it does not vanish. Not collective.
    virtual std::vector<Change> changes(std::size_t depth) const = 0;
};

/// What a correction is used for.
enum class Corrected { zz, all_components };

/// Where and for what a correction is computed: at these depths, on this rank's part of the plane.
struct CorrectedPlanes {
    const Medium& medium;
    const Domain& domain;
    const DepthMesh& mesh;
    const fft::SlabShare& share;
    std::vector<double> depths_m;
    Corrected use;
};
/// The correction around bodies across the domain (endless_stress.cpp) and around lumps
/// (lump_stress.cpp), which must outlive it. Not collective.
std::unique_ptr<StressCorrection> stress_correction(const EndlessBodies* bodies,
                                                    CorrectedPlanes planes);
std::unique_ptr<StressCorrection> stress_correction(const LumpBodies* lumps,
                                                    CorrectedPlanes planes);
/// Null for bodies without markers.
inline std::unique_ptr<StressCorrection> stress_correction(const RigidBodies& bodies,
                                                           CorrectedPlanes planes) {
    if (bodies.empty() || planes.depths_m.empty()) return nullptr;
    return std::visit(
        [&](const auto* treated) { return stress_correction(treated, std::move(planes)); },
        bodies.kind());
}

/// Memory of the corrections on the rank that needs most, in bytes. Not collective.
double endless_stress_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks);
double lump_stress_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
