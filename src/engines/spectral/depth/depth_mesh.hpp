// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/depth/mesh_pieces.hpp"
#include "problem/case/case.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace shearwake::spectral {

/// Gauss-Lobatto-Legendre rule with degree + 1 nodes on [-1, 1] including both ends, exact for
/// polynomials up to degree 2 degree - 1, and the derivative of the interpolating polynomial,
/// f'(x_i) = sum_j derivative[i (degree + 1) + j] f(x_j).
struct GaussLobatto {
    std::vector<double> nodes;
    std::vector<double> weights;
    std::vector<double> derivative;
};

/// The rule of a degree >= 1.
GaussLobatto gauss_lobatto(int degree);

/// Weights of the nodal values for the interpolating polynomial (Lagrange) at x in [-1, 1].
std::vector<double> interpolation_weights(const GaussLobatto& rule, double x);
/// Weights of the nodal values for the L2 projection of the interpolating polynomial onto
/// polynomials of two degrees less: sum over n of P_n(x) w_j P_n(x_j) (n + 1/2) with Legendre
/// polynomials P_n.
std::vector<double> smoothing_weights(const GaussLobatto& rule, double x);

/// Spectral elements in z with boundaries at the layer interfaces, graded towards the surface. Node
/// i of element e is the global level e * degree + i. Levels are numbered downward from the surface
/// at 0.
struct DepthMesh {
    int degree = 8;
    GaussLobatto rule;
    std::vector<double> ends_m;      // elements + 1, ascending from 0
    std::vector<std::size_t> layers; // layer of each element
    /// Whether a free rigid body that is lighter than the layer lies at the depths of an element.
    /// Its shear stiffness is then stable without the help of the material's inertia, which the
    /// body takes away (VerticalOperator). Empty without such a body.
    std::vector<bool> light;
    /// Absorber of a half-space, which forms the last elements.
    std::optional<AbsorbingBottom> bottom;

    std::size_t elements() const { return layers.size(); }
    bool has_light_body(std::size_t element) const { return !light.empty() && light[element]; }
    /// The last level is fixed: the base. An absorber ends in a level that moves and in one that
    /// holds the unknowns of its termination (kernels/slices.hpp), which have no depth.
    std::size_t levels() const {
        return elements() * static_cast<std::size_t>(degree) + (bottom ? 3 : 1);
    }
    double length_m(std::size_t element) const { return ends_m[element + 1] - ends_m[element]; }
    /// Depth of a level in metres, at most that of the end of the mesh.
    double z_m(std::size_t level) const;
    /// Number of levels whose motion is that of the medium: all above the absorber, including its
    /// top.
    std::size_t clear_levels() const;
    /// Their depths in metres.
    std::vector<double> clear_levels_m() const;
    /// Depth of the top of the absorber, or of the base.
    double clear_depth_m() const { return ends_m.back() - (bottom ? bottom->depth_m : 0.0); }
};

/// Chooses elements short enough for the motion that the load excites. At the surface they resolve
/// fields that decay as e^{-k z} up to the k where the spectrum of the footprint is 1e-3 (k h <= 9:
/// relative error 1e-4 at degree 8). Each element is at most 1.5 times as long as the previous one.
/// No element exceeds `longest_element_m` or twenty times the inverse wavenumber of shear waves at
/// the highest frequency that the load excites by 1 %. Where the time step would require
/// stabilisation of the finest shear mode of the first element, which reduces accuracy, this
/// element is up to twice as long, provided that losses damp the shortest waves or the requested
/// accuracy permits it. In the absorber of a half-space, which short waves do not reach, the length
/// is not limited. Throws UsageError if too many elements are needed. Not collective.
DepthMesh choose_mesh(const Case& c, const SpectralOptions& options, double step_s);

/// Interpolation at a depth: the first level of its element, and the weights of the element's
/// nodes.
struct DepthWeights {
    std::ptrdiff_t first;
    std::vector<double> weights;
};
DepthWeights depth_weights(const DepthMesh& mesh, double depth_m);

/// The largest eigenvalue of the stiffness D^T w D of the reference element relative to its mass w:
/// the squared wavenumber of the finest mode. For an element of length h multiply by (2/h)^2
/// [1/m^2].
double finest_mode(const GaussLobatto& rule);

} // namespace shearwake::spectral
