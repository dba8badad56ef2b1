// The stress at receptors that the spectral engine gives, on any number of ranks.
#include "support/spectral_cases.hpp"
#include "support/stop_at.hpp"
#include "support/stress_store.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <cmath>

using namespace shearwake;

namespace {

Case small_case(double contrast) {
    Case c = test::thin_layer(contrast);
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    return c;
}

} // namespace

TEST_CASE("the stress at receptors is the same on any number of ranks", "[mpi][neural]") {
    const Case c = small_case(GENERATE(1.0, 16.0));
    const Comm world = Comm::world();
    test::StressStore together;
    make_engine(c.solver)->run(c, world, together);
    const test::StressStore alone = test::stresses_of(c);
    const auto ny = static_cast<std::size_t>(c.domain.ny);
    const auto rows = static_cast<std::size_t>(together.slab().x_count) * ny,
               start = static_cast<std::size_t>(together.slab().x_start) * ny;
    CHECK(world.max(together.planes() == 12 && alone.planes() == 12 ? 0 : 1) == 0);
    double difference = 0.0, largest = 0.0;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        for (std::size_t depth = 0; depth < 3; ++depth)
            for (std::size_t i = 0; i < rows; ++i) {
                const double value = alone.at(n, depth)[start + i];
                difference = std::max(difference, std::abs(together.at(n, depth)[i] - value));
                largest = std::max(largest, std::abs(value));
            }
    CHECK(world.max(largest) > 0.1); // of 1 Pa
    // The sums of the iterations depend on the ranks to rounding, which lambda/mu = 1e5 lifts.
    CHECK(world.max(difference) < 1e-9);
}

TEST_CASE("the stress at receptors is the same when a run stops", "[mpi][neural]") {
    const Case c = small_case(2.0);
    const Comm world = Comm::world();
    test::StopAt checkpoints(GENERATE(3, 4, 5)); // every second step ends at a frame
    const std::vector<Vec2> places = {{1e-3, 2e-3}, {-4e-3, 0.0}, {0.5, 0.0}};
    const auto traces_of = [&](Checkpoints* stop) {
        SurfaceRecorder recorder(c, world, nullptr, {});
        recorder.keep_stress(places, {0, 1, 2});
        make_engine(c.solver)->run(c, world, recorder, stop);
        if (!stop) recorder.finish();
        return recorder;
    };
    const auto through = traces_of(nullptr);
    traces_of(&checkpoints);
    SurfaceRecorder rest(c, world, nullptr, {});
    rest.keep_stress(places, {0, 1, 2});
    make_engine(c.solver)->run(c, world, rest, &checkpoints);
    rest.finish();
    bool same = through.stresses_Pa()[0].u_m.front() != 0.0;
    for (std::size_t i = 0; i < places.size(); ++i)
        same = same && through.stresses_Pa()[i].u_m == rest.stresses_Pa()[i].u_m;
    CHECK(world.max(same ? 0 : 1) == 0);
}
