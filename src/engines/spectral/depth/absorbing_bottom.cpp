// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/absorbing_bottom.hpp"

#include "base/constants.hpp"
#include "problem/case/edge_absorption.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

/// The slow motion with the longest lateral period, e^{-kz} with k = 2 pi/extent, has rotation that
/// only distance attenuates: it returns as e^{-2 k depth} = 4e-5. At 0.55 the error of the surface
/// field is ten times as large.
constexpr double depth_per_extent = 0.8;

/// The greatest depth of a measurement, body or map.
double deepest_m(const Case& c) {
    double deepest = 0.0;
    const auto reach = [&](double z_m) {
        if (std::isfinite(z_m)) deepest = std::max(deepest, z_m);
    };
    for (const auto& depths_m : {c.measure.depths_m, stress_depths_m(c)})
        for (const double z_m : depths_m)
            reach(z_m);
    for (const Body& body : c.scene().medium.bodies)
        reach(bounds(body).high_m.z);
    if (c.scene().medium.map) reach(depths(*c.scene().medium.map).bottom_m);
    return deepest;
}

} // namespace

AbsorbingBottom absorbing_bottom(const Case& c, const SpectralOptions& options) {
    double interface_m = 0.0;
    for (const Layer& layer : c.scene().medium.layers)
        interface_m += layer.thickness_m;
    const double width_m = fwhm_m(c.scene().load.footprint);
    AbsorbingBottom bottom;
    bottom.longest_m = longest_wave_m(c.scene().load, c.scene().medium.layers.back().c_s_m_s);
    bottom.clear_m = std::max(
        {0.5 * bottom.longest_m - interface_m, deepest_m(c) + width_m - interface_m, width_m});
    bottom.depth_m =
        options.absorbing_depth_m > 0.0
            ? options.absorbing_depth_m
            : std::max(depth_per_extent * std::max(c.domain.extent_x_m(), c.domain.extent_y_m()),
                       1.5 * bottom.longest_m);
    return bottom;
}

double swirl_viscosity_Pa_s(const AbsorbingBottom& bottom, const Layer& layer, double into_m) {
    const double waves = two_pi * bottom.depth_m / bottom.longest_m;
    const double share = into_m / bottom.depth_m;
    return 45.0 / (waves * waves) * layer.density_kg_m3 * layer.c_s_m_s * bottom.depth_m *
           std::pow(share, 4);
}

} // namespace shearwake::spectral
