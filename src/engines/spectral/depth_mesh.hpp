#pragma once

#include "engines/spectral/absorbing_bottom.hpp"
#include "engines/spectral/gauss_lobatto.hpp"
#include "model/case.hpp"

#include <cstddef>
#include <optional>
#include <vector>

namespace shearwake {

/// Spectral elements in z, ends on the layer interfaces, graded toward the surface. Node i of
/// element e is the global level e * degree + i; levels grow downward from the surface at 0.
struct DepthMesh {
    int degree = 8;
    GaussLobatto rule;
    std::vector<double> ends_m;            // elements + 1, ascending from 0
    std::vector<std::size_t> layers;       // of each element
    std::optional<AbsorbingBottom> bottom; // of a half-space, as its last elements

    std::size_t elements() const { return layers.size(); }
    std::size_t levels() const { return elements() * static_cast<std::size_t>(degree) + 1; }
    double length_m(std::size_t element) const { return ends_m[element + 1] - ends_m[element]; }
    /// Depth of a level.
    double z_m(std::size_t level) const;
    /// The levels whose motion is the medium's: all above the absorber, its top included.
    std::size_t clear_levels() const;
    /// Depth of the absorber's top, or of the base.
    double clear_depth_m() const { return ends_m.back() - (bottom ? bottom->depth_m : 0.0); }
};

/// Elements short enough for what the load can excite: at the surface for fields that fall as
/// e^{-k z}, k up to where the footprint's spectrum is 1e-3 (k h <= 9: 1e-4 of them at degree 8);
/// growing by half from one to the next; nowhere longer than twenty times the inverse wavenumber of
/// the shear wave at the highest frequency that the load still excites by 1 %, nor than
/// `longest_element_m`. Where the time step would make the first element's finest shear mode need
/// stabilising, which costs accuracy, that element is up to twice as long, where losses damp the
/// shortest waves or the accuracy asked allows it. A half-space is a clear piece and an absorber,
/// whose elements grow without a limit: short waves do not get that far.
DepthMesh choose_mesh(const Case& c, const SpectralOptions& options);
/// The same for a time step of its own.
DepthMesh choose_mesh(const Case& c, const SpectralOptions& options, double step_s);

/// The largest eigenvalue of the reference element's stiffness D^T w D against its mass w: how fast
/// its finest mode varies, squared. On an element of length h, times (2/h)^2 [1/m^2].
double finest_mode(const GaussLobatto& rule);

} // namespace shearwake
