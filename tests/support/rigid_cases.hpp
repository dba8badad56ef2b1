// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/stepping/stepper.hpp"
#include "support/spectral_cases.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>

namespace shearwake::test {

enum class Along { x, y };

/// A 3 mm focus at 7 m/s over 12 mm of tissue, across a bone of 3 mm radius
/// that is parallel to x or y. It is switched off after 2 ms.
inline Case bone_case(Along axis, double viscosity_Pa_s) {
    Case c = focus_over_rigid_base(viscosity_Pa_s, {12e-3}, 0.0);
    const bool x = axis == Along::x;
    travel_of(c).path = x ? Curve({2e-3, -7e-3}, {1e-3, 7e-3}) : Curve({-7e-3, 2e-3}, {7e-3, 1e-3});
    c.scene.medium.bodies = {{.name = "bone",
                              .shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = x ? 0.0 : 90.0},
                              .centre_m = x ? Vec3{0.0, 1.3e-3, 6e-3} : Vec3{1.3e-3, 0.0, 6e-3},
                              .density_kg_m3 = 1900.0,
                              .rigid = true}};
    c.domain = x ? Domain{24, 32, 1.25e-3, 0.0} : Domain{32, 24, 1.25e-3, 0.0};
    c.time = {40, 100e-6};
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

/// The same focus across a rigid ellipsoid.
inline Case lump_case(double viscosity_Pa_s) {
    Case c = bone_case(Along::y, viscosity_Pa_s);
    Body& body = c.scene.medium.bodies[0];
    body.shape = Ellipsoid{{5e-3, 4e-3, 3e-3}};
    body.centre_m = {1.3e-3, 0.7e-3, 6e-3};
    c.domain.nx = 24;
    return c;
}

/// An elastic body above the bodies of these cases, four times stiffer and denser than the tissue.
inline Body elastic_neighbour() {
    return {.name = "lump",
            .shape = Ellipsoid{{4e-3, 4e-3, 1e-3}},
            .centre_m = {0.0, 0.0, 1.5e-3},
            .density_kg_m3 = 1200.0,
            .c_s_m_s = 10.0};
}

/// A box as wide as the domain along x and y, from 5 to 9 mm.
inline Body rigid_slab(const Case& c) {
    return {.name = "slab",
            .shape = Box{{c.domain.extent_x_m(), 1.0, 4e-3}},
            .centre_m = {0.0, 0.0, 7e-3},
            .density_kg_m3 = 1900.0,
            .rigid = true};
}

/// Advances a case on this rank alone and calls f(stepper) after each step.
template <class F>
void step_through(const Case& c, std::ptrdiff_t steps, const F& f) {
    const Comm rank = alone();
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, rank);
    const auto& options = std::get<SpectralOptions>(c.solver);
    const spectral::RigidPlan plan(c);
    spectral::Stepper stepper(plan, spectral::choose_mesh(plan.c, options, *options.time_step_s),
                              slabs, *options.time_step_s, rank);
    while (stepper.step() < steps) {
        stepper.advance();
        f(stepper);
    }
}

/// All steps of a case.
template <class F>
void step_through(const Case& c, const F& f) {
    step_through(
        c, std::lround(c.time.duration_s() / *std::get<SpectralOptions>(c.solver).time_step_s), f);
}

/// Checks, in every `stride`-th step after the end of the load, that the energy of a lossless case
/// of 14 ms equals the work of the load.
inline void check_conserved_energy(const Case& c, double step_s, long stride) {
    double after = 0.0, worst = 0.0, work = 0.0;
    const auto end = std::lround(2.2e-3 / step_s) + 2; // of the load and of its correction
    step_through(c, std::lround(14e-3 / step_s), [&](spectral::Stepper& stepper) {
        if (stepper.step() < end) return;
        if (stepper.step() > end && stepper.step() % stride != 0) return;
        const spectral::EnergyBalance balance = stepper.energy();
        if (stepper.step() == end) after = balance.energy_J, work = balance.work_J;
        worst = std::max(worst, std::abs(balance.energy_J / after - 1.0));
    });
    CAPTURE(step_s, after, work, worst);
    CHECK(after > 0.0);
    CHECK(worst < 1e-8);                        // as without bodies
    CHECK(after == Approx(work).epsilon(1e-8)); // the forces on the bodies do no work
}

/// Largest difference of a field and the mirror image, in the plane x = 0 or y = 0, of another one.
inline double asymmetry(const Domain& domain, const std::vector<double>& frame,
                        const std::vector<double>& mirrored, Along axis = Along::x) {
    const std::ptrdiff_t nx = domain.nx, ny = domain.ny;
    double worst = 0.0;
    for (std::ptrdiff_t i = axis == Along::x ? 1 : 0; i < nx; ++i)
        for (std::ptrdiff_t j = axis == Along::y ? 1 : 0; j < ny; ++j) {
            const std::ptrdiff_t image = axis == Along::x ? (nx - i) * ny + j : i * ny + ny - j;
            worst = worse(worst, std::abs(frame[static_cast<std::size_t>(i * ny + j)] -
                                          mirrored[static_cast<std::size_t>(image)]));
        }
    return worst;
}

} // namespace shearwake::test
