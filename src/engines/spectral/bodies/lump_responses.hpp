// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/lump_bodies.hpp"

namespace shearwake::spectral {

/// Fills this rank's columns of G = J B^-1 J' for the markers of lumps. Collective.
void put_responses(const std::vector<LumpBodies::Marker>& markers,
                   const std::vector<DepthWeights>& depths, const Domain& domain,
                   const DepthMesh& mesh, const WaveVectors& vectors,
                   const fft::SlabTransform& slabs, const Comm& team, StepClock& clock,
                   const VerticalOperator& op, const RigidBodies::Solve& solve,
                   BlockInverse& matrix);

} // namespace shearwake::spectral
