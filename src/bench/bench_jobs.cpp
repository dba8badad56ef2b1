// SPDX-License-Identifier: BSD-3-Clause
#include "bench/bench_jobs.hpp"

#include "bench/bench.hpp"

#include <cmath>

namespace shearwake::bench {
namespace {

/// The case of `bench layered` on another grid, with frames 50 us apart.
Case on_grid(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m, std::ptrdiff_t frames) {
    Case c = layered_bench_case();
    c.domain = {nx, ny, spacing_m, 0.0};
    c.time.frames = frames;
    c.measure.at_s = c.time.duration_s();
    c.measure.settled_after_s = 0.25 * c.measure.at_s;
    return c;
}

Body body_of(double c_s_m_s) {
    return {.name = "body",
            .shape = Ellipsoid{{2e-2, 1.5e-2, 2e-3}},
            .centre_m = {0.0, 0.0, 6e-3},
            .c_s_m_s = c_s_m_s};
}

/// A map of fat whose stiffness increases along x.
std::shared_ptr<const MaterialMap> map_of_fat() {
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
AfferentOptions afferents_of(AfferentInput input) {
    AfferentOptions options{.places = GridAfferents{{40e-3, 30e-3}, 2e-3}, .input = input};
    options.pins_m.clear();
    for (int i = -2; i <= 2; ++i)
        for (int j = -2; j <= 2; ++j)
            options.pins_m.push_back({4e-3 * i, 4e-3 * j});
    return options;
}

/// The case without the epidermis, a film that an explicit scheme would have to resolve.
Case pstd_case(std::ptrdiff_t nx, std::ptrdiff_t ny, std::ptrdiff_t frames,
               const PstdOptions& options) {
    Case c = on_grid(nx, ny, 1e-3, frames);
    c.scene().medium.layers.erase(c.scene().medium.layers.begin());
    for (Layer& layer : c.scene().medium.layers)
        layer.c_p_m_s = 30.0;
    c.time.interval_s = 100e-6;
    c.measure.at_s = c.time.duration_s();
    c.scene().load.modulation.trajectory.parts = {
        Travel{{{-1e-2, 0.0}, {2e-1, 0.0}}, ConstantSpeed{7.0}}};
    c.solver = options;
    return c;
}

/// A grid study: a plane source within a uniform solid.
Case study_case() {
    StudyData study{.points = {64, 60, 48},
                    .spacing_m = {1e-3, 1e-3, 1e-3},
                    .time_step_s = 10e-6,
                    .steps = 200,
                    .layer_points = {10, 10, 10},
                    .layer_strength = {2.0, 2.0, 2.0},
                    .density_kg_m3 = {1000.0},
                    .c_p_m_s = {30.0},
                    .c_s_m_s = {5.0},
                    .sensor_fields = {2}};
    NodeSource source{.field = 2, .samples = study.steps};
    for (std::ptrdiff_t x = 24; x < 40; ++x)
        for (std::ptrdiff_t y = 22; y < 38; ++y) {
            source.nodes.push_back({x, y, 14});
            source.weights.push_back(1e-3);
            source.rows.push_back(0);
            study.sensors.push_back({x, y, 24});
        }
    for (std::ptrdiff_t n = 0; n < study.steps; ++n)
        source.series.push_back(std::sin(0.05 * static_cast<double>(n)));
    study.sources = {std::move(source)};
    study.content_hash = hash_of(study);
    Case c = pstd_case(32, 32, 20, {});
    c.problem = GridStudy{std::make_shared<const StudyData>(std::move(study)), c.scene()};
    c.solver = PstdOptions{};
    return c;
}

std::vector<BenchJob> layered_jobs() {
    Case kept = on_grid(256, 192, 0.75e-3, 160);
    kept.record.frames = true;
    kept.measure.depths_m = {0.0, 2e-3};
    Case stress = on_grid(128, 96, 1e-3, 200);
    stress.afferents = afferents_of(StressInput{});
    Case pins = on_grid(96, 72, 1.25e-3, 400);
    pins.afferents = afferents_of(PinInput{});
    Case open = on_grid(192, 144, 1e-3, 160);
    open.domain.edges = DomainEdges::open;
    return {{"layered, open edges", open},
            {"layered, periodic regime", steady_bench_case()},
            {"layered, small", on_grid(96, 72, 1.5e-3, 160)},
            {"layered, large", on_grid(384, 288, 0.5e-3, 300)},
            {"layered, two depths, frames", kept},
            {"layered, stress at receptors", stress},
            {"layered, pins and receptors", pins}};
}

/// One body of bone each, which is rigid.
std::vector<BenchJob> bone_jobs() {
    const auto job_with = [](const Body& body) {
        Case c = on_grid(96, 72, 1e-3, 60);
        c.scene().medium.bodies.push_back(body);
        c.solver = SpectralOptions{.time_step_s = c.time.interval_s};
        return c;
    };
    Body bone = body_of(1619.0);
    bone.density_kg_m3 = 1900.0;
    bone.c_p_m_s = 3517.0;
    bone.shape = Ellipsoid{{6e-3, 5e-3, 3e-3}};
    Body across = bone;
    across.shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0};
    return {{"spectral, rigid lump", job_with(bone)},
            {"spectral, rigid cylinder", job_with(across)}};
}

std::vector<BenchJob> spectral_jobs() {
    Case small = on_grid(96, 72, 1.5e-3, 160);
    small.scene().medium.layers.erase(
        small.scene().medium.layers.begin()); // a film requires many steps
    small.solver = SpectralOptions{.accuracy = 1e-2};
    Case large = on_grid(256, 192, 0.75e-3, 100);
    large.domain.sponge_m = 20e-3;
    large.solver = SpectralOptions{.time_step_s = large.time.interval_s};
    Case body = on_grid(192, 144, 1e-3, 50);
    body.scene().medium.bodies.push_back(body_of(5.0));
    body.solver = SpectralOptions{.time_step_s = body.time.interval_s};
    body.record.volumes_s = {1e-3, 2e-3};
    body.record.volume_fields = {VolumeField::u};
    Case stiff = on_grid(96, 72, 1.5e-3, 60);
    stiff.scene().medium.bodies.push_back(body_of(30.0));
    stiff.solver = SpectralOptions{.time_step_s = stiff.time.interval_s};
    stiff.record.volumes_s = {3e-3};
    stiff.record.volume_fields = {VolumeField::strain, VolumeField::stress};
    Case map = on_grid(96, 72, 1.5e-3, 120);
    map.scene().medium.map = map_of_fat();
    map.solver = SpectralOptions{.time_step_s = map.time.interval_s};
    map.afferents = afferents_of(StressInput{});
    return {{"spectral, small, step probed", small},
            {"spectral, large, sponge", large},
            {"spectral, body, displacements", body},
            {"spectral, stiff body, tensors", stiff},
            {"spectral, map, receptors", map}};
}

/// Elastic bodies several hundred times stiffer than the layers, which the focus crosses.
std::vector<BenchJob> stiff_jobs() {
    const auto job_with = [](const auto& shape) {
        Case c = on_grid(96, 72, 1e-3, 60);
        c.scene().medium.layers.erase(c.scene().medium.layers.begin());
        c.scene().load.modulation.trajectory.parts = {
            Travel{{{-1.5e-2, 0.0}, {2e-1, 0.0}}, ConstantSpeed{7.0}}};
        c.scene().medium.bodies.push_back(body_of(60.0));
        c.scene().medium.bodies[0].shape = shape;
        c.solver = SpectralOptions{.time_step_s = c.time.interval_s, .rigid_above = 1e6};
        return c;
    };
    return {{"spectral, very stiff lump", job_with(Ellipsoid{{9e-3, 7e-3, 2e-3}})},
            {"spectral, very stiff box", job_with(Box{{14e-3, 12e-3, 4e-3}})},
            {"spectral, very stiff cylinder",
             job_with(Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0})}};
}

std::vector<BenchJob> pstd_jobs() {
    Case lossy = pstd_case(96, 72, 20, {.precision = Precision::single_precision});
    lossy.scene().medium.bodies.push_back(body_of(5.0));
    lossy.record.volumes_s = {2e-3};
    lossy.record.volume_fields = {VolumeField::u};
    return {{"pstd, single, body, volume", lossy}, {"pstd, grid study", study_case()}};
}

} // namespace

std::vector<BenchJob> bench_jobs() {
    std::vector<BenchJob> all;
    for (auto* jobs : {layered_jobs, spectral_jobs, bone_jobs, stiff_jobs, pstd_jobs})
        for (BenchJob& job : jobs())
            all.push_back(std::move(job));
    return all;
}

} // namespace shearwake::bench
