// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"

#include "simd/kernels.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// A component of u at one node: u_x = i (c U - s V), u_y = i (s U + c V), u_z = W.
void component_of(std::size_t component, const WaveBlock& waves, const Block* uw, const Block* v,
                  Block* value) {
    for (std::ptrdiff_t p = 0; p < parts; ++p) {
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
            const double k = waves.k[lane], kx = p < minus_re ? waves.kx[lane] : -waves.kx[lane];
            const double c = k > 0.0 ? kx / k : 1.0, s = k > 0.0 ? waves.ky / k : 0.0;
            value[p][lane] = component == 0   ? c * uw[p][lane] - s * v[p][lane]
                             : component == 1 ? s * uw[p][lane] + c * v[p][lane]
                                              : uw[parts + p][lane];
        }
    }
    if (component == 2) return;
    for (const std::ptrdiff_t p : {plus_re, minus_re}) {
        std::swap(value[p], value[p + 1]);
        for (double& negated : value[p].lane)
            negated = -negated;
    }
}

} // namespace

void Stepper::plane_of_u(std::size_t component, std::size_t level, double* plane) const {
    const auto at_level = static_cast<std::ptrdiff_t>(level);
    const LineKernels& lines = simd::kernels<LineKernels>();
    for (std::ptrdiff_t row = 0; row < state_.vectors.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < state_.vectors.blocks(); ++block) {
            const Block* u = state_.u(state_.pencil(row, block));
            const WaveBlock waves = state_.vectors.waves(row, block);
            Block value[parts] = {};
            if (at_level < state_.vertical.levels())
                component_of(component, waves, u + 2 * at_level * parts,
                             u + (state_.vertical.psv() + at_level) * parts, value);
            lines.put(waves, {}, value, plane + 2 * row * state_.vectors.nx());
        }
    }
    state_.vectors.clear_nyquist(plane);
}

void Stepper::plane_of_w(double depth_m, double* plane) const {
    const auto above =
        std::upper_bound(state_.mesh.ends_m.begin(), state_.mesh.ends_m.end() - 1, depth_m);
    const auto element = static_cast<std::size_t>(above - state_.mesh.ends_m.begin()) - 1;
    const std::vector<double> weights = interpolation_weights(
        state_.mesh.rule,
        2.0 * (depth_m - state_.mesh.ends_m[element]) / state_.mesh.length_m(element) - 1.0);
    const auto first = static_cast<std::ptrdiff_t>(element) * state_.mesh.degree;
    const LineKernels& lines = simd::kernels<LineKernels>();
    for (std::ptrdiff_t row = 0; row < state_.vectors.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < state_.vectors.blocks(); ++block) {
            const Block* u = state_.u(state_.pencil(row, block));
            Block w[parts] = {};
            for (std::ptrdiff_t i = 0; i <= state_.mesh.degree; ++i) {
                const double weight = weights[static_cast<std::size_t>(i)];
                const std::ptrdiff_t unknown = 2 * (first + i) + 1;
                if (unknown >= state_.vertical.psv() || weight == 0.0)
                    continue; // the base does not move
                for (std::ptrdiff_t part = 0; part < parts; ++part)
                    add_scaled(weight, u[unknown * parts + part], w[part]);
            }
            lines.put(state_.vectors.waves(row, block), {}, w,
                      plane + 2 * row * state_.vectors.nx());
        }
    }
    state_.vectors.clear_nyquist(plane);
}

} // namespace shearwake::spectral
