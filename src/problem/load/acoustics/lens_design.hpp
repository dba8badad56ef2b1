// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "problem/load/acoustics/lens.hpp"
#include "problem/load/acoustics/patch.hpp"

#include <array>
#include <complex>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

namespace shearwake {

/// The phases of a lens and its field on the skin.
struct LensDesign {
    std::ptrdiff_t pixels = 0;     // along each side of the square around the aperture
    std::vector<double> phase_rad; // of pixel (i, j), y fastest; NaN outside the aperture
    Patch pattern;                 // |p|^2 on the skin divided by its peak, faded out
    double width_m = 0.0;          // equivalent diameter of the spot around the peak, where |p|^2
                                   // is above a half
    double gain = 0.0;             // peak pressure on the skin per pressure at the lens
    double efficiency = 0.0;       // power that arrives where the target exceeds a half, divided
                                   // by the power that leaves the lens
    double uniformity = 1.0;       // 1 - (max - min) / (max + min) of |p|^2 at the foci
    /// After each iteration, and finally after the rounding of the phases: 1 - (sum |p|
    /// |p_target|)^2 / (sum |p_target|^2 P) with the power P behind the lens, the fraction of the
    /// power that does not arrive with the amplitude of the target.
    std::vector<double> errors;
};

/// Computes the phases by the iterative algorithm of Melde et al. (Nature 537, 518, 2016), with the
/// propagation of square pixels: propagation to the skin, replacement of the amplitude by that of
/// the target, propagation back, and replacement of the amplitude by that of the lens. The way back
/// is the adjoint of the way there: each iteration then maximises a linear lower bound of the
/// convex function sum |p| |p_target|, so that the error decreases. Deterministic. Not collective.
LensDesign design_lens(const LensFootprint& lens);

/// The pressure on the skin for these phases of the pixels and unit amplitude at the lens, on the
/// lattice of the lens; y fastest. Valid up to fading_end_m() from the axis.
std::vector<std::complex<double>> field_on_skin(const LensFootprint& lens,
                                                const std::vector<double>& phase_rad);

/// The design of a lens: the one that it carries, or a new one.
std::shared_ptr<const LensDesign> design_of(const LensFootprint& lens);

/// Designs that have been computed, so that the cases of a sweep share them.
class LensDesigns {
public:
    std::shared_ptr<const LensDesign> of(const LensFootprint& lens);

private:
    std::vector<LensFootprint> known_;
};

/// Columns of square cross-section on a plane: heights (i, j), y fastest; 0 or less: no column.
struct HeightMap {
    std::ptrdiff_t side = 0;
    double pixel_m = 0.0;
    std::vector<double> heights_m;
};

using Triangle = std::array<Vec3, 3>;

/// The surface of the columns, centred on the z axis, from z = 0 upwards; the corners of each
/// triangle are counterclockwise as seen from outside [m]. Closed: each edge occurs equally often
/// in both directions.
std::vector<Triangle> surface_of(const HeightMap& map);

/// A binary STL file in millimetres.
std::string binary_stl(const std::vector<Triangle>& triangles);

} // namespace shearwake
