// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "support/cases.hpp"
#include "support/worst.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <vector>

namespace shearwake::test {

/// The case with the engine "spectral" and this time step.
inline Case with_step(Case c, double step_s) {
    SpectralOptions options;
    if (const auto* given = std::get_if<SpectralOptions>(&c.solver)) options = *given;
    options.time_step_s = step_s;
    c.solver = options;
    return c;
}

/// A 3 mm focus at 7 m/s over 7 mm of tissue on a rigid base. It is switched off after 3 ms; the
/// remaining waves keep travelling through the periodic domain.
inline Case small_tissue(double viscosity_Pa_s = 0.5) {
    Case c = focus_over_rigid_base(viscosity_Pa_s, {7e-3}, -11e-3, 10e-3);
    c.domain = {24, 18, 1e-3, 0.0};
    c.time = {30, 100e-6};
    c.measure = {.at_s = 3e-3, .settled_after_s = 1e-3, .focal_radius_m = 3e-3};
    return c;
}

/// An ellipsoid under the path of `small_tissue`, initially with the properties of its
/// surroundings.
inline Body small_body() {
    return {
        .name = "body", .shape = Ellipsoid{{5e-3, 3.5e-3, 1.5e-3}}, .centre_m = {2e-3, 2e-3, 3e-3}};
}

/// The ellipsoid with `contrast` times the shear stiffness of its surroundings.
inline Body small_body(double contrast) {
    Body body = small_body();
    body.c_s_m_s = 5.0 * std::sqrt(contrast);
    return body;
}

/// A 4 mm layer with an ellipsoid of `contrast` times its shear stiffness (1: none), in steps of 50
/// us.
inline Case thin_layer(double contrast) {
    Case c = focus_over_rigid_base(1.0, {4e-3}, -3e-3);
    if (contrast > 1.0)
        c.scene.medium.bodies = {{.name = "body",
                                  .shape = Ellipsoid{{5e-3, 4e-3, 1e-3}},
                                  .centre_m = {1e-3, 2e-3, 2e-3},
                                  .c_s_m_s = 5.0 * std::sqrt(contrast)}};
    c.domain = {18, 14, 1e-3, 0.0}; // slabs of different sizes on 5 ranks
    c.time = {4, 100e-6};
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

/// An ellipsoid with `contrast` times the shear stiffness of the tissue.
inline Body ellipsoid(double contrast) {
    return {.name = "body",
            .shape = Ellipsoid{{6e-3, 4e-3, 2e-3}},
            .centre_m = {2e-3, 3e-3, 4e-3},
            .c_s_m_s = 5.0 * std::sqrt(contrast)};
}

/// A map from 3.0 to 6.2 mm over the plane, without values.
inline std::shared_ptr<MaterialMap> sheet_map() {
    auto map = std::make_shared<MaterialMap>();
    map->counts = {1, 1, 16};
    map->origin_m = {0.0, 0.0, 3.1e-3};
    map->spacing_m = {0.0, 0.0, 0.2e-3};
    return map;
}

/// Divides a layer into three of these thicknesses.
inline void divide_layer(Case& c, const std::array<double, 3>& thicknesses_m) {
    c.scene.medium.layers.assign(3, c.scene.medium.layers[0]);
    for (std::size_t i = 0; i < 3; ++i)
        c.scene.medium.layers[i].thickness_m = thicknesses_m[i];
}

/// A rigid body across the periodic edges of thin_layer().
inline Body rigid_across_the_edge(const decltype(Body::shape)& shape) {
    return {.name = "rigid",
            .shape = shape,
            .centre_m = {-8.3e-3, -6.1e-3, 3e-3},
            .density_kg_m3 = 1900.0,
            .rigid = true};
}

/// thin_layer() without and with an elastic body, also with a rigid lump, and with a rigid
/// cylinder.
inline std::vector<Case> cases_with_bodies() {
    const Body lump = rigid_across_the_edge(Ellipsoid{{3e-3, 2.5e-3, 0.7e-3}});
    std::vector<Case> cases = {thin_layer(1.0), thin_layer(16.0)};
    for (const double contrast : {1.0, 16.0}) {
        cases.push_back(thin_layer(contrast));
        cases.back().scene.medium.bodies.push_back(lump);
    }
    for (const double azimuth_deg : {0.0, 90.0}) {
        cases.push_back(thin_layer(1.0));
        cases.back().scene.medium.bodies = {
            rigid_across_the_edge(Cylinder{.radius_m = 1.2e-3, .azimuth_deg = azimuth_deg})};
    }
    return cases;
}

inline double relative_l2(const std::vector<double>& a, const std::vector<double>& b) {
    double above = 0.0, below = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        above += std::pow(a[i] - b[i], 2);
        below += b[i] * b[i];
    }
    return std::sqrt(above / below);
}

inline std::vector<double> last_frame(const Case& c) {
    return frames_of(c).at(c.time.frames - 1);
}

/// Relative L2 difference of all frames from those of another run.
inline double relative_l2(const FrameStore& a, const FrameStore& b, std::ptrdiff_t frames) {
    std::vector<double> values, expected;
    for (std::ptrdiff_t n = 0; n < frames; ++n) {
        values.insert(values.end(), a.at(n).begin(), a.at(n).end());
        expected.insert(expected.end(), b.at(n).begin(), b.at(n).end());
    }
    return relative_l2(values, expected);
}

/// The largest magnitude; infinity if a value is not finite.
inline double largest(const std::vector<double>& values) {
    double result = 0.0;
    for (const double value : values)
        result = worse(result, std::abs(value));
    return result;
}

/// Relative difference between the trace under a footprint at the second place due to a load at
/// the first one, and that with both exchanged. Reciprocity makes them equal: the operator is
/// symmetric. The sampled footprint of the receiver differs from the band-limited one of the source
/// by 1e-3 of the peak of its spectrum at the edge, for a spacing of a third of its width.
inline double reciprocity_error(Case c, const std::array<Vec2, 2>& places) {
    std::vector<double> recorded[2]; // for all frames
    for (std::size_t i = 0; i < 2; ++i) {
        c.scene.load.modulation.trajectory = {{Hold{places[i]}}};
        const FrameStore frames = frames_of(c);
        const Vec2 there = places[1 - i];
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            const auto& frame = frames.at(n);
            recorded[i].push_back(0.0);
            for (std::ptrdiff_t x = 0; x < c.domain.nx; ++x)
                for (std::ptrdiff_t y = 0; y < c.domain.ny; ++y)
                    recorded[i].back() +=
                        frame[static_cast<std::size_t>(x * c.domain.ny + y)] *
                        pressure(c.scene.load.footprint, c.domain.x_m(x) - there.x,
                                 c.domain.y_m(y) - there.y);
        }
    }
    return relative_l2(recorded[0], recorded[1]);
}

inline double mean(const std::vector<double>& values) {
    double sum = 0.0;
    for (const double value : values)
        sum += value;
    return sum / static_cast<double>(values.size());
}

} // namespace shearwake::test
