// SPDX-License-Identifier: BSD-3-Clause
// Compares results on all ranks with those of each rank alone.
#include "support/cases.hpp"
#include "support/stop_at.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>

namespace test_layered_ranks {

using namespace shearwake;

static Case small_case() {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    Layer film = c.scene.medium.layers[0];
    film.thickness_m = 0.3e-3;
    film.c_s_m_s = 20.0;
    c.scene.medium.layers.insert(c.scene.medium.layers.begin(), film);
    c.domain = {70, 54, 0.75e-3, 3e-3}; // divisible by 2 only
    c.time = {60, 50e-6};
    auto& travel = test::travel_of(c);
    std::get<Line>(travel.path.shape).from_m = {-15e-3, -2e-3};
    c.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 1000.0}}};
    c.measure.at_s = 3e-3;
    c.measure.settled_after_s = 1e-3;
    c.measure.depths_m = {0.0, 1e-3};
    c.record.traces_m = {{0.0, 0.0}, {3.3e-3, -1.1e-3}};
    return c;
}

/// On a rigid base, for engine "spectral".
static Case on_rigid_base(double thickness_m, std::ptrdiff_t frames) {
    Case c = small_case();
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers.back().thickness_m = thickness_m;
    c.time.frames = frames;
    c.solver = SpectralOptions{};
    return c;
}

/// In a layer of 3 mm, on a grid of few points.
static Case with_thin_body(const Domain& domain, std::ptrdiff_t frames, const Vec3& half_axes_m,
                           double c_s_m_s) {
    Case c = on_rigid_base(3e-3, frames);
    c.domain = domain;
    c.scene.medium.bodies = {{.name = "body",
                              .shape = Ellipsoid{half_axes_m},
                              .centre_m = {1e-3, 2e-3, 1.5e-3},
                              .c_s_m_s = c_s_m_s}};
    c.record.traces_m.clear();
    return c;
}

/// Counts how often the engine asks whether to stop.
class Asked : public test::NoCheckpoints {
public:
    bool stop_asked() override {
        ++times_;
        return false;
    }
    int times() const { return times_; }

private:
    int times_ = 0;
};

/// Largest difference of all frames, relative to the largest value of the frame.
static double worst_frame(const Case& c, const Comm& world) {
    test::FrameStore shared;
    Asked asked;
    engines::make_engine(c.solver)->run(c, world, shared, &asked);
    CHECK(world.max(asked.times()) == world.min(asked.times())); // the question is collective
    const test::FrameStore single = test::frames_of_root(c, world);
    double worst = 0.0;
    for (std::size_t depth = 0; depth < c.measure.depths_m.size(); ++depth) {
        for (std::ptrdiff_t n = 0; n < c.time.frames; ++n) {
            const auto offset = static_cast<std::size_t>(shared.slab().x_start * c.domain.ny);
            worst =
                test::worse(worst, test::apart(shared.at(n, depth), single.at(n, depth), offset));
        }
    }
    return world.max(worst);
}

TEST_CASE("frames of engine layered are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    const bool oblique = GENERATE(false, true); // the general code path of the load's transform
    if (oblique) std::get<Line>(test::travel_of(c).path.shape).to_m = {150e-3, 40e-3};
    CHECK(worst_frame(c, Comm::world()) < 1e-12); // required
}

TEST_CASE("frames with open edges are identical on any number of ranks", "[mpi]") {
    Case c = small_case();
    c.domain.edges = DomainEdges::open; // rows of the padded grid outside the domain are dropped
    if (GENERATE(false, true)) {
        c.scene.load.modulation.trajectory = {{Travel{
            Arc{{1e-3, 0.0}, 5e-3, 0.0, 6.283185307179586}, ConstantSpeed{2.0}, AtEnd::repeat}}};
        c.scene.load.modulation.envelope = {};
        c.time = {40, 6.283185307179586 * 5e-3 / 2.0 / 40.0, Regime::periodic};
        c.measure.at_s = c.time.duration_s();
        for (Layer& layer : c.scene.medium.layers)
            layer.loss = KelvinVoigt{1.0};
    }
    CHECK(worst_frame(c, Comm::world()) < 1e-12); // required
}

TEST_CASE("frames of a moving array focus are identical on any number of ranks",
          "[mpi][extended]") {
    Case c = on_rigid_base(8e-3, 20);
    c.scene.load.footprint = ArrayFootprint{.reach_m = 0.02};
    c.measure.depths_m = {0.0};
    if (GENERATE(false, true)) c.solver = LayeredOptions{};
    // Each wave vector is computed by one rank in the same way.
    CHECK(worst_frame(c, Comm::world()) < 1e-12);
}

TEST_CASE("frames of engine spectral are identical on any number of ranks", "[mpi]") {
    Case c = on_rigid_base(8e-3, 20); // the sponge acts on fewer wave vectors, in separate slabs
    if (GENERATE(true, false)) c.scene.medium = small_case().scene.medium;
    // Each wave vector is computed by one rank in the same way.
    CHECK(worst_frame(c, Comm::world()) < 1e-12);
}

TEST_CASE("frames with a map are identical on any number of ranks", "[mpi][extended]") {
    Case c = on_rigid_base(8e-3, 8);
    auto map = std::make_shared<MaterialMap>();
    map->counts = {5, 4, 6};
    map->origin_m = {-4e-3, -2e-3, 2e-3};
    map->spacing_m = {2e-3, 1.5e-3, 0.5e-3};
    for (int i = 0; i < 120; ++i)
        map->c_s_m_s.push_back(6.0 + 0.1 * i);
    map->content_hash = hash_of(*map);
    c.scene.medium.map = map;
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required; observed: the same bits
}

TEST_CASE("frames with bodies are identical on any number of ranks", "[mpi]") {
    Case c = on_rigid_base(8e-3, 8);
    c.scene.medium.bodies = {{.name = "body",
                              .shape = Ellipsoid{{5e-3, 4e-3, 2e-3}},
                              .centre_m = {1e-3, 2e-3, 4e-3},
                              .density_kg_m3 = 1300.0}};
    const double c_s_m_s = GENERATE(2.5, 20.0, 0.0);
    if (c_s_m_s > 0.0)
        c.scene.medium.bodies[0].c_s_m_s = c_s_m_s;
    else
        c.scene.medium.bodies[0].rigid = true;
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required; observed: the same bits
}

TEST_CASE("iterations have the same bits on any number of ranks after many steps", "[mpi]") {
    // Modes that are too weak for conjugate gradients to detect grow from rounding until they are
    // detected: a different last bit in one sum would cause a difference of 1e-7 after 200 steps.
    Case c = with_thin_body({24, 18, 1.5e-3, 0.0}, 120, {6e-3, 4e-3, 1e-3}, 30.0);
    c.scene.medium.bodies[0].viscosity_Pa_s = 1.5;
    c.solver = SpectralOptions{.time_step_s = 12.5e-6};
    CHECK(worst_frame(c, Comm::world()) == 0.0);
}

TEST_CASE("ranks without planes do not affect the frames on any number of ranks", "[mpi]") {
    // 5 ranks have 2 rows each; 4 have one ky each.
    const Case c = with_thin_body({10, 6, 2e-3, 0.0}, 20, {5e-3, 4e-3, 1e-3}, 20.0);
    CHECK(worst_frame(c, Comm::world()) < 1e-11); // required
}

TEST_CASE("series and table are identical on any number of ranks", "[mpi]") {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const Case c = small_case();
    const auto record = [&](const Comm& team) {
        pipeline::SurfaceRecorder recorder(c, team, {});
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
        REQUIRE(mean.size() == mean_alone.size());
        worst = test::worse(worst, test::apart(mean, mean_alone));
    }
    for (std::size_t i = 0; i < traces.size(); ++i)
        worst = test::worse(worst, test::apart(traces[i].u_m, traces_alone[i].u_m));
    CHECK(world.max(worst) < 1e-12); // required
}

} // namespace test_layered_ranks
