// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/stepping/stepper.hpp"
#include "support/spectral_cases.hpp"

namespace shearwake::test {

enum class Along { x, y };

/// A 3 mm focus at 7 m/s over 12 mm of tissue, across a bone of 3 mm radius
/// that is parallel to x or y. It is switched off after 2 ms.
inline Case bone_case(Along axis, double viscosity_Pa_s) {
    Case c = moving_focus({}, ConstantSpeed{7.0});
    Layer layer = tissue(1500.0, viscosity_Pa_s);
    layer.thickness_m = 12e-3;
    c.scene().medium = {{layer}, Base::rigid};
    const bool x = axis == Along::x;
    std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]).path =
        x ? Curve({2e-3, -7e-3}, {1e-3, 7e-3}) : Curve({-7e-3, 2e-3}, {7e-3, 1e-3});
    c.scene().medium.bodies = {{.name = "bone",
                                .shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = x ? 0.0 : 90.0},
                                .centre_m = x ? Vec3{0.0, 1.3e-3, 6e-3} : Vec3{1.3e-3, 0.0, 6e-3},
                                .density_kg_m3 = 1900.0,
                                .rigid = true}};
    c.domain = x ? Domain{24, 32, 1.25e-3, 0.0} : Domain{32, 24, 1.25e-3, 0.0};
    c.time = {40, 100e-6};
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

/// Advances a case on this rank alone and calls f(stepper) after each step.
template <class F>
void step_through(const Case& c, std::ptrdiff_t steps, const F& f) {
    const Comm alone = Comm::world().split(Comm::world().rank());
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, alone);
    const auto& options = std::get<SpectralOptions>(c.solver);
    spectral::Stepper stepper(c, spectral::choose_mesh(c, options, *options.time_step_s), slabs,
                              *options.time_step_s, alone);
    while (stepper.step() < steps) {
        stepper.advance();
        f(stepper);
    }
}

} // namespace shearwake::test
