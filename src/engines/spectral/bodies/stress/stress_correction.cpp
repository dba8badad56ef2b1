// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/stress_correction.hpp"

#include "engines/spectral/bodies/endless_bodies.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/stress/endless_stress.hpp"
#include "engines/spectral/bodies/stress/lump_stress.hpp"

namespace shearwake::spectral {

std::unique_ptr<StressCorrection> stress_correction(const RigidBodies& bodies, const Medium& medium,
                                                    const Domain& domain, const DepthMesh& mesh,
                                                    const fft::SlabShare& share,
                                                    std::vector<double> depths_m, Corrected use) {
    if (bodies.empty() || depths_m.empty()) return nullptr;
    if (const LumpBodies* lumps = bodies.as_lumps())
        return std::make_unique<LumpStress>(*lumps, medium, domain, mesh, share,
                                            std::move(depths_m), use);
    if (const EndlessBodies* endless = bodies.as_endless())
        return std::make_unique<EndlessStress>(*endless, medium, domain, mesh, share,
                                               std::move(depths_m));
    return nullptr;
}

} // namespace shearwake::spectral
