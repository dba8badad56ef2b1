// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "bench/bench.hpp"

#include <cmath>
#include <string>
#include <vector>

namespace shearwake::test {

/// A case and its name. Long cases take 2 s and more on three ranks and two cores.
struct FeatureCase {
    std::string name;
    Case physics;
    bool is_long = false;
};

/// The case of `bench layered` on another grid, with frames 50 us apart.
inline Case on_grid(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m, std::ptrdiff_t frames) {
    Case c = bench::layered_bench_case();
    c.domain = {nx, ny, spacing_m, 0.0};
    c.time.frames = frames;
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.25 * c.measure.at_s;
    return c;
}

inline Body body_of(double c_s_m_s) {
    return {.name = "body",
            .shape = Ellipsoid{{2e-2, 1.5e-2, 2e-3}},
            .centre_m = {0.0, 0.0, 6e-3},
            .c_s_m_s = c_s_m_s};
}

/// A map of fat whose stiffness increases along x.
inline std::shared_ptr<const MaterialMap> map_of_fat() {
    MaterialMap map{.file = "map",
                    .content_hash = "",
                    .counts = {32, 24, 8},
                    .origin_m = {-31e-3, -23e-3, 4e-3},
                    .spacing_m = {2e-3, 2e-3, 1e-3}};
    for (std::ptrdiff_t i = 0; i < map.counts[0] * map.counts[1] * map.counts[2]; ++i)
        map.c_s_m_s.push_back(2.3 + 0.03 * static_cast<double>(i / (24 * 8)));
    map.content_hash = hash_of(map);
    return std::make_shared<const MaterialMap>(std::move(map));
}

/// Fibres of the palm on a patch of 40 mm x 30 mm, and a grid of pins.
inline AfferentOptions afferents_of(AfferentInput input) {
    AfferentOptions options{.places = GridAfferents{{40e-3, 30e-3}, 2e-3}, .input = input};
    options.pins_m.clear();
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            options.pins_m.push_back({4e-3 * i, 4e-3 * j});
    return options;
}

/// The case without the epidermis, a film that an explicit scheme would have to resolve.
inline Case pstd_case(std::ptrdiff_t nx, std::ptrdiff_t ny, std::ptrdiff_t frames,
                      const PstdOptions& options) {
    Case c = on_grid(nx, ny, 1e-3, frames);
    c.scene.medium.layers.erase(c.scene.medium.layers.begin());
    for (Layer& layer : c.scene.medium.layers)
        layer.c_p_m_s = 30.0;
    c.time.interval_s = 100e-6;
    c.measure.at_s = c.time.duration_s();
    c.scene.load.modulation.trajectory.parts = {
        Travel{{{-1e-2, 0.0}, {2e-1, 0.0}}, ConstantSpeed{7.0}}};
    c.solver = options;
    return c;
}

inline std::vector<FeatureCase> layered_jobs() {
    Case kept = on_grid(256, 192, 0.75e-3, 160);
    kept.record.frames = true;
    kept.measure.depths_m = {0.0, 2e-3};
    Case stress = on_grid(128, 96, 1e-3, 200);
    stress.afferents = afferents_of(StressInput{});
    Case pins = on_grid(96, 72, 1.25e-3, 400);
    pins.afferents = afferents_of(PinInput{});
    Case open = on_grid(192, 144, 1e-3, 160);
    open.domain.edges = DomainEdges::open;
    Case steady = open;
    steady.scene.load.modulation.trajectory = {
        {Travel{Arc{{}, 10e-3, 0.0, two_pi}, ConstantSpeed{two_pi}, AtEnd::repeat}}};
    steady.time = {128, 10e-3 / 128.0, Regime::periodic};
    steady.measure.at_s = steady.time.duration_s();
    steady.measure.settled_after_s = 0.0;
    Case array = on_grid(128, 96, 1e-3, 100);
    array.scene.load.footprint = ArrayFootprint{.distance_m = 0.15, .reach_m = 0.03};
    Case tilted = on_grid(96, 72, 1e-3, 100);
    tilted.vibrometer = VibrometerOptions{.points_m = {{0.0, 0.0}, {5e-3, 0.0}}, .tilt_rad = 0.5};
    return {{"layered, open edges", open},
            {"layered, array", array},
            {"layered, tilted vibrometer", tilted},
            {"layered, periodic regime", steady},
            {"layered, small", on_grid(96, 72, 1.5e-3, 160)},
            {"layered, large", on_grid(384, 288, 0.5e-3, 300)},
            {"layered, two depths, frames", kept},
            {"layered, stress at receptors", stress},
            {"layered, pins and receptors", pins}};
}

/// One body of bone each, which is rigid.
inline std::vector<FeatureCase> bone_jobs() {
    const auto job_with = [](const Body& body) {
        Case c = on_grid(96, 72, 1e-3, 60);
        c.scene.medium.bodies.push_back(body);
        c.solver = SpectralOptions{.time_step_s = c.time.interval_s};
        return c;
    };
    Body bone = body_of(1619.0);
    bone.density_kg_m3 = 1900.0;
    bone.c_p_m_s = 3517.0;
    bone.shape = Ellipsoid{{6e-3, 5e-3, 3e-3}};
    Body across = bone;
    across.shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0};
    Body large = bone;
    large.shape = Ellipsoid{{20e-3, 16e-3, 4e-3}};
    Body slab = bone;
    slab.shape = Box{{1.0, 1.0, 2e-3}};
    Case both = job_with(bone);
    across.centre_m.z = 14e-3;
    both.scene.medium.bodies.push_back(across);
    both.time.frames = 10;
    both.measure.at_s = both.time.duration_s();
    both.measure.settled_after_s = 0.0;
    const auto with_stress = [](Case c) {
        c.afferents = afferents_of(StressInput{});
        c.time.frames = 20;
        c.measure.at_s = c.time.duration_s();
        c.measure.settled_after_s = 0.0;
        c.record.volumes_s = {0.5e-3};
        c.record.volume_fields = {VolumeField::strain, VolumeField::stress};
        return c;
    };
    return {{"spectral, rigid lump", job_with(bone)},
            {"spectral, rigid cylinder", job_with(across)},
            {"spectral, large rigid lump", job_with(large), true},
            {"spectral, rigid layer", job_with(slab)},
            {"spectral, rigid lump and cylinder", both, true},
            {"spectral, rigid lump, receptors, tensors", with_stress(job_with(bone)), true},
            {"spectral, rigid cylinder, receptors, tensors", with_stress(job_with(across))}};
}

inline std::vector<FeatureCase> spectral_jobs() {
    Case small = on_grid(96, 72, 1.5e-3, 160);
    small.scene.medium.layers.erase(
        small.scene.medium.layers.begin()); // a film requires many steps
    small.solver = SpectralOptions{.accuracy = 1e-2};
    Case large = on_grid(256, 192, 0.75e-3, 100);
    large.domain.sponge_m = 20e-3;
    large.solver = SpectralOptions{.time_step_s = large.time.interval_s};
    Case body = on_grid(192, 144, 1e-3, 50);
    body.scene.medium.bodies.push_back(body_of(5.0));
    body.solver = SpectralOptions{.time_step_s = body.time.interval_s};
    body.record.volumes_s = {1e-3, 2e-3};
    body.record.volume_fields = {VolumeField::u};
    Case stiff = on_grid(96, 72, 1.5e-3, 60);
    stiff.scene.medium.bodies.push_back(body_of(30.0));
    stiff.solver = SpectralOptions{.time_step_s = stiff.time.interval_s};
    stiff.record.volumes_s = {3e-3};
    stiff.record.volume_fields = {VolumeField::strain, VolumeField::stress};
    Case soft = on_grid(96, 72, 1.5e-3, 40);
    soft.scene.medium.bodies.push_back(body_of(2.0));
    soft.scene.medium.bodies[0].density_kg_m3 = 900.0;
    soft.solver = SpectralOptions{.time_step_s = soft.time.interval_s};
    Case map = on_grid(96, 72, 1.5e-3, 120);
    map.scene.medium.map = map_of_fat();
    map.solver = SpectralOptions{.time_step_s = map.time.interval_s};
    map.afferents = afferents_of(StressInput{});
    Case absorbed = on_grid(96, 72, 1.5e-3, 40);
    absorbed.scene.medium.base = Base::half_space;
    absorbed.scene.medium.bodies.push_back(body_of(10.0));
    absorbed.domain.sponge_m = 15e-3;
    absorbed.solver = SpectralOptions{.time_step_s = absorbed.time.interval_s};
    // Sampled on a part of the points; a run of a few frames less would not use a box.
    Case many = on_grid(96, 72, 1e-3, 97);
    many.solver = SpectralOptions{.time_step_s = many.time.interval_s};
    for (int i = 0; i < 12; ++i) {
        Body lump = body_of(15.0);
        lump.density_kg_m3 = 1300.0;
        lump.shape = Ellipsoid{{1.7e-3, 1.7e-3, 1.7e-3}};
        lump.centre_m = {4.1e-3 * (i % 4 - 1.5), 4.1e-3 * (i / 4 - 1), 4e-3};
        many.scene.medium.bodies.push_back(lump);
    }
    return {{"spectral, half-space, sponge, body", absorbed, true},
            {"spectral, twelve bodies in a box", many, true},
            {"spectral, small, step probed", small},
            {"spectral, large, sponge", large, true},
            {"spectral, body, displacements", body, true},
            {"spectral, stiff body, tensors", stiff, true},
            {"spectral, soft and light body", soft, true},
            {"spectral, map, receptors", map, true}};
}

/// Elastic bodies several hundred times stiffer than the layers, which the focus crosses.
inline std::vector<FeatureCase> stiff_jobs() {
    const auto job_with = [](const auto& shape) {
        Case c = on_grid(96, 72, 1e-3, 60);
        c.scene.medium.layers.erase(c.scene.medium.layers.begin());
        c.scene.load.modulation.trajectory.parts = {
            Travel{{{-1.5e-2, 0.0}, {2e-1, 0.0}}, ConstantSpeed{7.0}}};
        c.scene.medium.bodies.push_back(body_of(60.0));
        c.scene.medium.bodies[0].shape = shape;
        c.solver = SpectralOptions{.time_step_s = c.time.interval_s, .rigid_above = 1e6};
        return c;
    };
    return {{"spectral, very stiff lump", job_with(Ellipsoid{{9e-3, 7e-3, 2e-3}}), true},
            {"spectral, very stiff box", job_with(Box{{14e-3, 12e-3, 4e-3}})},
            {"spectral, very stiff cylinder",
             job_with(Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0}), true}};
}

inline std::vector<FeatureCase> pstd_jobs() {
    Case lossy = pstd_case(96, 72, 20, {.precision = Precision::single_precision});
    lossy.scene.medium.bodies.push_back(body_of(5.0));
    lossy.record.volumes_s = {2e-3};
    lossy.record.volume_fields = {VolumeField::u};
    const Case plain = pstd_case(96, 72, 20, {});
    Case absorbing = plain;
    absorbing.domain.sponge_m = 10e-3;
    absorbing.solver = PstdOptions{.top = PstdTop::fluid};
    Case moved = plain;
    moved.solver = PstdOptions{.load = PstdLoad::displacement};
    return {{"pstd, plain", plain, true},
            {"pstd, absorbing margin, force", absorbing, true},
            {"pstd, prescribed displacement", moved, true},
            {"pstd, single, body, volume", lossy, true}};
}

/// Cases of all engines, about 0.1 to 10 s each: small and large grids, bodies, a map, receptors,
/// and volumes.
inline std::vector<FeatureCase> feature_cases() {
    std::vector<FeatureCase> all;
    for (auto* jobs : {layered_jobs, spectral_jobs, bone_jobs, stiff_jobs, pstd_jobs})
        for (FeatureCase& job : jobs())
            all.push_back(std::move(job));
    return all;
}

} // namespace shearwake::test
