// SPDX-License-Identifier: BSD-3-Clause
// The stress of the spectral engine at receptors on any number of ranks.
#include "support/spectral_cases.hpp"
#include "support/stop_at.hpp"
#include "support/stress_store.hpp"

#include <catch2/catch.hpp>

namespace test_receptor_stress {

using namespace shearwake;

static Case recorded(Case c) {
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    return c;
}

TEST_CASE("receptor stress is identical on any number of ranks", "[mpi][neural]") {
    const Case c = recorded(GENERATE(from_range(test::cases_with_bodies())));
    const Comm world = Comm::world();
    test::StressStore together;
    engines::make_engine(c.solver)->run(c, world, together);
    const test::StressStore alone = test::frames_of_root<test::StressStore>(c, world);
    const auto start = static_cast<std::size_t>(together.slab().x_start * c.domain.ny);
    CHECK(world.max(together.planes() == 12 && alone.planes() == 12 ? 0 : 1) == 0);
    test::Deviation difference;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        for (std::size_t depth = 0; depth < 3; ++depth)
            difference.add(together.at(n, depth), alone.at(n, depth), start);
    CHECK(world.max(difference.of) > 0.1); // relative to 1 Pa
    // The sums of the iterations differ by rounding, which lambda/mu = 1e5 amplifies.
    CHECK(world.max(difference.largest) < 1e-9);
}

TEST_CASE("receptor stress is unchanged when a run stops and resumes", "[mpi][neural]") {
    const Case c = recorded(test::thin_layer(2.0));
    const Comm world = Comm::world();
    test::StopAt checkpoints(GENERATE(3, 4, 5)); // every second step ends at a frame
    const std::vector<Vec2> places = {{1e-3, 2e-3}, {-4e-3, 0.0}, {0.5, 0.0}};
    const auto run = [&](pipeline::SurfaceRecorder& recorder, engines::Checkpoints* stop) {
        recorder.record_stress(places, {0, 1, 2});
        engines::make_engine(c.solver)->run(c, world, recorder, stop);
    };
    pipeline::SurfaceRecorder through(c, world, {}), stopped(c, world, {}), resumed(c, world, {});
    run(through, nullptr);
    through.finish();
    run(stopped, &checkpoints);
    run(resumed, &checkpoints);
    resumed.finish();
    bool same = through.stresses_Pa()[0].u_m.front() != 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
        same = same && through.stresses_Pa()[i].u_m == resumed.stresses_Pa()[i].u_m;
    CHECK(world.max(same ? 0 : 1) == 0);
}

} // namespace test_receptor_stress
