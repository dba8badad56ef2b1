#pragma once

#include "engines/pstd/grid.hpp"

#include <functional>
#include <limits>
#include <span>

namespace shearwake::pstd {

/// `dirichlet` is k-Wave's, `whole` sets the total of a velocity.
enum class SourceMode { additive, dirichlet, whole };

/// What an additive source's values are multiplied by. k-Wave: 2 c_p dt/d at each node for a
/// velocity (d along its own axis), 2 c_p dt/(3 dx) in each split part for a stress; with the c_p
/// of the first node for all when a single series drives many nodes.
enum class SourceScaling { none, kwave, kwave_of_first_node };

/// Samples of one field at some nodes; sample n is put in at the end of step n + 1's update of that
/// field. Additive: velocities grow by the scaled value; normal stresses likewise, a third in each
/// of their parts; shear stresses by a third in each of their two. Dirichlet: a velocity's own part
/// (d/dx for ux) becomes the value while its other parts go on; stresses' parts become a third of
/// it each. Whole, of a velocity: the total becomes the value; its own part takes up what the
/// others are. After the last sample nothing is done any more.
struct Source {
    Field field = Field::uz;
    SourceMode mode = SourceMode::additive;
    SourceScaling scaling = SourceScaling::kwave;
    std::vector<Node> nodes = {}; // each once, of the whole grid, the same on all ranks
    /// Of a velocity: whether what it adds counts in Kelvin-Voigt's strain rates. k-Wave's does
    /// not, so that a force in a viscous medium is too strong (by 18 % after a millisecond at 1 Pa
    /// s).
    bool in_rates = false;
    std::ptrdiff_t samples = std::numeric_limits<std::ptrdiff_t>::max();
    /// Values of a sample at nodes[which[...]]. Not collective: each rank asks for its own.
    std::function<void(std::ptrdiff_t sample, std::span<const std::size_t> which,
                       std::span<double> values)>
        values = {};
};

/// pattern[node] series[sample].
Source separable_source(Source source, std::vector<double> pattern, std::vector<double> series);

/// samples[node][sample], row-major.
Source sampled_source(Source source, std::vector<double> samples);

/// What u or the stress of `mode` additive must be given for a body force density f [N/m^3] at a
/// node: f dt/rho, unscaled.
constexpr double velocity_of_force_m_s(double force_N_m3, double dt_s, double density_kg_m3) {
    return force_N_m3 * dt_s / density_kg_m3;
}

} // namespace shearwake::pstd
