#pragma once

#include "model/medium.hpp"

#include <cstddef>

namespace shearwake {

/// What engines with lateral variation multiply by: sigma = lambda div u + 2 mu strain, with
/// mu + viscosity d/dt in place of mu.
struct Material {
    double density_kg_m3 = 0.0;
    double lambda_Pa = 0.0;
    double mu_Pa = 0.0;
    double viscosity_Pa_s = 0.0;
    bool operator==(const Material&) const = default;
};

/// lambda = rho (c_p^2 - 2 c_s^2) and mu = rho c_s^2. Kelvin-Voigt's viscosity; 0 for the lossless
/// layer and for the other laws, which have none: engines refuse those before.
Material material_of(const Layer& layer);

/// The material of a cell that lies in layer number `layer`: the layer's, with what the map gives
/// at the cell's centre in its place, then mixed with each body in turn by the share f it fills, (1
/// - f) m + f m_body for density, lambda, mu and viscosity. What a body does not give is that of
/// the layer and the map.
Material material_of_cell(const Medium& medium, std::size_t layer, Vec3 centre_m, Vec3 size_m);

/// Whether anything but the layers may be there between two depths. Cheap: looks at bounds only.
bool varies_between(const Medium& medium, double top_m, double bottom_m);

} // namespace shearwake
