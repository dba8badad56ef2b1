// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "fft/aligned.hpp"

#include <functional>
#include <vector>

namespace shearwake::spectral {

/// Amplitudes of the stress of one wave vector due to unit forces along it (r), across it (t) and
/// along z, without factors i.
struct RadialStress {
    struct Vertical {
        double rr, tt, zz, rz;
    };
    Vertical along_r, along_z;
    double rt, tz; // of the force along t
};

/// The elements around the forces and stresses, continued on both sides, and the depth of the
/// first end.
struct LongMesh {
    DepthMesh mesh;
    double top_m;
};

/// Node weights at a depth in an element: of the value, the slope, and both smoothed.
struct NodeWeights {
    std::ptrdiff_t first;
    double share; // of this element
    std::vector<double> value, slope, smooth, smooth_slope;
};

/// The static stress due to forces at some depths of a uniform solid without boundaries, for single
/// wave vectors, as the engine computes it: with the elements of a mesh over depth, and the
/// pressure smoothed over depth as at receptors. Elements continue the mesh above the surface and
/// below the base. Not collective.
class StaticResponse {
public:
    /// For pairs of depths at most `reach_m` apart, and at least one force. `outer_m` are the
    /// lengths of the elements on either side of those within reach of the forces.
    StaticResponse(const DepthMesh& mesh, double lambda_per_mu, std::vector<double> force_m,
                   std::vector<double> stress_m, double reach_m,
                   const std::vector<double>& outer_m);

    using Use = std::function<void(std::size_t stress_depth, std::size_t force_depth,
                                   std::ptrdiff_t lane, const RadialStress& stress)>;
    /// Calls use() for all pairs of depths and the first `lanes` of these wavenumbers [rad/m]. At
    /// 0 it is the mean stress, half of which acts on either side of a force.
    void each(const Block& k_rad_m, std::ptrdiff_t lanes, const Use& use);

private:
    double lambda_per_mu_, reach_m_;
    std::vector<double> force_m_, stress_m_;
    LongMesh mesh_;
    VerticalOperator operator_;
    std::vector<NodeWeights> force_at_;               // per depth
    std::vector<std::vector<NodeWeights>> stress_at_; // per depth, of one or two elements
    fft::AlignedVector<Block> factor_, pencil_;
};

} // namespace shearwake::spectral
