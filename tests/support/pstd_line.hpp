// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/pstd_recording.hpp"

#include <functional>

namespace shearwake::test {

/// A line of nodes along z, uniform in x and y and without absorbing layer: one-dimensional waves.
inline pstd::Setup pstd_line(std::ptrdiff_t points, double dz_m, double dt_s,
                             const std::function<pstd::NodeMaterial(std::ptrdiff_t)>& at_z) {
    pstd::Setup s;
    s.grid = {{1, 1, points}, {dz_m, dz_m, dz_m}, dt_s};
    s.pml.strength_1 = {0.0, 0.0, 0.0};
    s.material = [at_z](pstd::Node n) { return at_z(n[2]); };
    return s;
}

inline std::vector<double> values_along(const pstd::Stepper<double>& stepper, pstd::Field field,
                                        const Comm& team) {
    return pstd::values_in<double>(stepper, field, {{0, 0, 0}, {1, 1, stepper.slabs().nz()}}, team);
}

} // namespace shearwake::test
