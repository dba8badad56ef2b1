// SPDX-License-Identifier: BSD-3-Clause
// Compares results on all ranks with those of each rank alone.
#include "engines/checkpoint.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "support/cases.hpp"
#include "support/gathered_state.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>

namespace test_layered_ranks {

using namespace shearwake;

namespace {

Case small_case() {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    Layer film = c.scene().medium.layers[0];
    film.thickness_m = 0.3e-3;
    film.c_s_m_s = 20.0;
    c.scene().medium.layers.insert(c.scene().medium.layers.begin(), film);
    c.domain = {70, 54, 0.75e-3, 3e-3}; // divisible by 2 only
    c.time = {60, 50e-6};
    auto& travel = std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]);
    std::get<Line>(travel.path.shape).from_m = {-15e-3, -2e-3};
    c.scene().load.modulation.envelope = {{SineGain{.frequency_Hz = 1000.0}}};
    c.measure.at_s = 3e-3;
    c.measure.settled_after_s = 1e-3;
    c.measure.depths_m = {0.0, 1e-3};
    c.record.traces_m = {{0.0, 0.0}, {3.3e-3, -1.1e-3}};
    return c;
}

/// A free bone of 2 mm radius along x (0 degrees) or y (90 degrees).
Case rigid_case(double azimuth_deg) {
    Case c = small_case();
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 8e-3;
    c.scene().medium.bodies = {{.name = "bone",
                                .shape = Cylinder{.radius_m = 2e-3, .azimuth_deg = azimuth_deg},
                                .centre_m = {1e-3, 2e-3, 4e-3},
                                .density_kg_m3 = 1900.0,
                                .rigid = true}};
    c.domain.sponge_m = 6e-3;
    c.time.frames = 20;
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

/// Counts how often the engine asks whether to stop.
class Asked : public engines::Checkpoints {
public:
    bool due() override { return false; }
    void save(const std::function<void(StateWriter&)>& /*write*/) override {}
    bool restore(const std::function<void(const StateReader&)>& /*read*/) override { return false; }
    bool stop() const override { return false; }
    bool stop_asked() override {
        ++times_;
        return false;
    }
    int times() const { return times_; }

private:
    int times_ = 0;
};

/// Largest difference of all frames, relative to the largest value of the frame.
double worst_frame(const Case& c, const Comm& world) {
    test::FrameStore shared;
    Asked asked;
    engines::make_engine(c.solver)->run(c, world, shared, &asked);
    CHECK(world.max(asked.times()) == world.min(asked.times())); // the question is collective
    const test::FrameStore single = test::frames_of_root(c, world);
    double worst = 0.0;
    for (std::size_t depth = 0; depth < c.measure.depths_m.size(); ++depth) {
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            const auto &part = shared.at(n, depth), &whole = single.at(n, depth);
            double largest = 0.0;
            for (const double u : whole)
                largest = std::max(largest, std::abs(u));
            const auto offset = static_cast<std::size_t>(shared.slab().x_start * c.domain.ny);
            for (std::size_t i = 0; i < part.size(); ++i)
                worst = test::worse(worst, std::abs(part[i] - whole[offset + i]) / largest);
        }
    }
    return world.max(worst);
}

} // namespace

TEST_CASE("frames of engine layered are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    const bool oblique = GENERATE(false, true); // the general code path of the load's transform
    if (oblique)
        std::get<Line>(std::get<Travel>(c.scene().load.modulation.trajectory.parts[0]).path.shape)
            .to_m = {150e-3, 40e-3};
    CHECK(worst_frame(c, Comm::world()) < 1e-12); // required
}

TEST_CASE("frames with open edges are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.domain.edges = DomainEdges::open; // rows of the padded grid outside the domain are dropped
    if (GENERATE(false, true)) {
        c.scene().load.modulation.trajectory = {{Travel{
            Arc{{1e-3, 0.0}, 5e-3, 0.0, 6.283185307179586}, ConstantSpeed{2.0}, AtEnd::repeat}}};
        c.scene().load.modulation.envelope = {};
        c.time = {40, 6.283185307179586 * 5e-3 / 2.0 / 40.0, Regime::periodic};
        c.measure.at_s = c.time.duration_s();
        for (Layer& layer : c.scene().medium.layers)
            layer.loss = KelvinVoigt{1.0};
    }
    CHECK(worst_frame(c, Comm::world()) < 1e-12); // required
}

TEST_CASE("frames of a moving array focus are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.scene().load.footprint = ArrayFootprint{.reach_m = 0.02};
    c.measure.depths_m = {0.0};
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 8e-3;
    c.time.frames = 20;
    if (GENERATE(false, true)) c.solver = SpectralOptions{};
    // Each wave vector is computed by one rank in the same way.
    CHECK(worst_frame(c, Comm::world()) < 1e-12);
}

TEST_CASE("frames of engine spectral are identical on any number of ranks", "[mpi]") {
    Case c = small_case(); // the sponge acts on fewer wave vectors, in separate slabs
    if (GENERATE(true, false)) {
        c.scene().medium.base = Base::rigid;
        c.scene().medium.layers.back().thickness_m = 8e-3;
    }
    c.time.frames = 20;
    c.solver = SpectralOptions{};
    // Each wave vector is computed by one rank in the same way.
    CHECK(worst_frame(c, Comm::world()) < 1e-12);
}

TEST_CASE("frames with a map are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 8e-3;
    auto map = std::make_shared<MaterialMap>();
    map->counts = {5, 4, 6};
    map->origin_m = {-4e-3, -2e-3, 2e-3};
    map->spacing_m = {2e-3, 1.5e-3, 0.5e-3};
    for (int i = 0; i < 120; ++i)
        map->c_s_m_s.push_back(6.0 + 0.1 * i);
    map->content_hash = hash_of(*map);
    c.scene().medium.map = map;
    c.time.frames = 8;
    c.solver = SpectralOptions{};
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required; observed: the same bits
}

TEST_CASE("frames with bodies are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 8e-3;
    c.scene().medium.bodies = {{.name = "body",
                                .shape = Ellipsoid{{5e-3, 4e-3, 2e-3}},
                                .centre_m = {1e-3, 2e-3, 4e-3},
                                .density_kg_m3 = 1300.0,
                                .c_s_m_s = GENERATE(2.5, 20.0)}};
    c.time.frames = 8;
    c.solver = SpectralOptions{};
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required; observed: the same bits
}

TEST_CASE("frames with a rigid body are identical on any number of ranks", "[mpi]") {
    const double azimuth_deg = GENERATE(0.0, 90.0);
    CAPTURE(azimuth_deg);
    CHECK(worst_frame(rigid_case(azimuth_deg), Comm::world()) < 1e-12); // required
}

TEST_CASE("a checkpoint with a rigid body continues on any number of ranks", "[mpi]") {
    const double azimuth_deg = GENERATE(0.0, 90.0);
    const Case c = rigid_case(azimuth_deg);
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const auto stepper_on = [&](const fft::SlabTransform& slabs, const Comm& team) {
        return spectral::Stepper(
            c, spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver), 50e-6), slabs, 50e-6,
            team);
    };
    const fft::SlabTransform shared(c.domain.nx, c.domain.ny, world),
        whole(c.domain.nx, c.domain.ny, alone);
    spectral::Stepper all = stepper_on(shared, world), single = stepper_on(whole, alone);
    for (int i = 0; i < 20; ++i)
        all.advance();
    test::GatheredState by_all(world), by_one(alone);
    all.save(by_all);
    single.restore(by_all);
    for (int i = 0; i < 20; ++i)
        single.advance();
    single.save(by_one);
    spectral::Stepper resumed = stepper_on(shared, world); // and the other way round
    resumed.restore(by_one);
    for (int i = 0; i < 20; ++i) {
        single.advance();
        resumed.advance();
    }
    single.save(by_one);
    resumed.save(by_all);
    for (const std::string name : {"now", "before", "rigid_bodies"}) {
        const auto &one = by_one.rows(name), &other = by_all.rows(name);
        REQUIRE(one.size() == other.size());
        double worst = 0.0, largest = 0.0;
        for (std::size_t i = 0; i < one.size(); ++i) {
            worst = test::worse(worst, std::abs(one[i] - other[i]));
            largest = std::max(largest, std::abs(one[i]));
        }
        CAPTURE(azimuth_deg, name, largest);
        CHECK(largest > 0.0);
        CHECK(worst < 1e-12 * largest); // required
    }
}

TEST_CASE("iterations have the same bits on any number of ranks after many steps", "[mpi]") {
    // Modes that are too weak for conjugate gradients to detect grow from rounding until they are
    // detected: a different last bit in one sum would cause a difference of 1e-7 after 200 steps.
    Case c = small_case();
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 3e-3;
    c.domain = {24, 18, 1.5e-3, 0.0};
    c.scene().medium.bodies = {{.name = "body",
                                .shape = Ellipsoid{{6e-3, 4e-3, 1e-3}},
                                .centre_m = {1e-3, 2e-3, 1.5e-3},
                                .c_s_m_s = 30.0,
                                .viscosity_Pa_s = 1.5}};
    c.time = {120, 50e-6};
    c.record.traces_m.clear();
    SpectralOptions options;
    options.time_step_s = 12.5e-6;
    c.solver = options;
    CHECK(worst_frame(c, Comm::world()) == 0.0);
}

TEST_CASE("ranks without planes do not affect the frames on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.scene().medium.base = Base::rigid;
    c.scene().medium.layers.back().thickness_m = 3e-3;
    c.domain = {10, 6, 2e-3, 0.0}; // 5 ranks have 2 rows each; 4 have one ky each
    c.scene().medium.bodies = {{.name = "body",
                                .shape = Ellipsoid{{5e-3, 4e-3, 1e-3}},
                                .centre_m = {1e-3, 2e-3, 1.5e-3},
                                .c_s_m_s = 20.0}};
    c.time.frames = 20;
    c.record.traces_m.clear();
    c.solver = SpectralOptions{};
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required
}

TEST_CASE("series and table are identical on any number of ranks", "[mpi]") {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const Case c = small_case();
    const auto record = [&](const Comm& team) {
        pipeline::SurfaceRecorder recorder(c, team, nullptr, {});
        engines::make_engine(c.solver)->run(c, team, recorder);
        recorder.finish();
        return std::tuple(recorder.depths(), recorder.traces(), recorder.mean_u2());
    };
    const auto [depths, traces, mean] = record(world);
    const auto [depths_alone, traces_alone, mean_alone] = record(alone);
    double worst = 0.0;
    const auto compare = [&](double a, double b) {
        worst = test::worse(worst, std::abs(a - b) / std::abs(b));
    };
    for (std::size_t d = 0; d < depths.size(); ++d) {
        for (std::size_t n = 0; n < depths[d].frames.size(); ++n) {
            const measures::SurfaceSums &a = depths[d].frames[n], &b = depths_alone[d].frames[n];
            compare(a.abs_u, b.abs_u);
            compare(a.u2, b.u2);
            compare(a.u4, b.u4);
            compare(a.focal_u2, b.focal_u2);
            compare(a.focal_weight, b.focal_weight);
            compare(a.peak, b.peak);
            // Volume is conserved, so that the signed sum is the result of cancellation in sum |u|.
            worst = test::worse(worst, std::abs(a.u - b.u) / b.abs_u);
        }
    }
    CHECK(mean_alone.size() == static_cast<std::size_t>(c.domain.nx * c.domain.ny));
    if (world.is_root()) {
        const double largest = *std::max_element(mean_alone.begin(), mean_alone.end());
        for (std::size_t n = 0; n < mean_alone.size(); ++n)
            worst = test::worse(worst, std::abs(mean.at(n) - mean_alone[n]) / largest);
    }
    for (std::size_t i = 0; i < traces.size(); ++i) {
        double largest = 0.0;
        for (const double u : traces_alone[i].u_m)
            largest = std::max(largest, std::abs(u));
        for (std::size_t n = 0; n < traces[i].u_m.size(); ++n)
            worst =
                test::worse(worst, std::abs(traces[i].u_m[n] - traces_alone[i].u_m[n]) / largest);
    }
    CHECK(world.max(worst) < 1e-12); // required
}

} // namespace test_layered_ranks
