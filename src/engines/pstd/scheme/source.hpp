// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/grid.hpp"

#include <functional>
#include <limits>
#include <span>

namespace shearwake::pstd {

/// `dirichlet` is that of k-Wave; `total` prescribes the total of a velocity.
enum class SourceMode { additive, dirichlet, total };

/// Scaling of the values of an additive source. k-Wave: 2 c_p dt/d at each node for a velocity (d
/// along its own axis), 2 c_p dt/(3 dx) in each split part for a stress; with the c_p of the first
/// node for all nodes if a single series drives many nodes.
enum class SourceScaling { none, kwave, kwave_of_first_node };

/// Samples of one field at some nodes. Sample n is applied at the end of step n + 1's update of
/// that field. Additive: the scaled value is added to a velocity; to a normal stress it is added
/// with one third in each of its three parts, to a shear stress with one third in each of its two
/// parts. Dirichlet: the own part of a velocity (d/dx for ux) is set to the value while its other
/// parts evolve; each part of a stress is set to one third of the value. In a plane two parts of a
/// stress have one half each, and the part of d/dx of a normal stress has nothing. Whole: the total
/// of a velocity is set to the value by adjusting its own part. Nothing is applied after the last
/// sample.
struct Source {
    Field field = Field::uz;
    SourceMode mode = SourceMode::additive;
    SourceScaling scaling = SourceScaling::kwave;
    std::vector<Node> nodes = {}; // unique, of the complete grid, identical on all ranks
    /// Whether the velocity that is added contributes to the strain rates of Kelvin-Voigt media. In
    /// k-Wave it does not, so that a force in a viscous medium is too strong (by 18 % after a
    /// millisecond at 1 Pa s).
    bool in_rates = false;
    std::ptrdiff_t samples = std::numeric_limits<std::ptrdiff_t>::max();
    /// Computes the values of a sample at nodes[which[...]]. A node whose value is not a number
    /// (NaN) receives nothing from this sample. Not collective: each rank evaluates its own nodes.
    std::function<void(std::ptrdiff_t sample, std::span<const std::size_t> which,
                       std::span<double> values)>
        values = {};
};

/// Unscaled value of an additive velocity source for a body force density f [N/m^3] at a node: f
/// dt/rho.
constexpr double velocity_of_force_m_s(double force_N_m3, double dt_s, double density_kg_m3) {
    return force_N_m3 * dt_s / density_kg_m3;
}

} // namespace shearwake::pstd
