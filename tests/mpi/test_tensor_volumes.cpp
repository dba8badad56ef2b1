// SPDX-License-Identifier: BSD-3-Clause
// Strain and stress volumes of the spectral engine on any number of ranks.
#include "support/spectral_cases.hpp"
#include "support/stop_at.hpp"
#include "support/volume_store.hpp"

#include <catch2/catch.hpp>

namespace test_tensor_volumes {

using namespace shearwake;

static Case recorded(Case c) {
    c.record.volumes_s = {c.time.frame_s(1), c.time.frame_s(3)};
    c.record.volume_fields = {VolumeField::u, VolumeField::strain, VolumeField::stress};
    return c;
}

TEST_CASE("volumes are unchanged when a run stops at or near a snapshot", "[mpi]") {
    const Case c = recorded(test::thin_layer(2.0));
    const Comm world = Comm::world();
    test::StopAt checkpoints(GENERATE(3, 4, 5, 7)); // the snapshots are at steps 4 and 8
    test::VolumeStore through, stopped;
    engines::make_engine(c.solver)->run(c, world, through);
    engines::make_engine(c.solver)->run(c, world, stopped, &checkpoints);
    CHECK(stopped.planes() < through.planes());
    engines::make_engine(c.solver)->run(c, world, stopped, &checkpoints);
    bool same = stopped.planes() == through.planes();
    for (std::size_t snapshot = 0; same && snapshot < 2; ++snapshot)
        for (std::size_t k = 0; k < 6; ++k)
            for (std::size_t level = 0; level < through.z_m().size(); ++level)
                same =
                    same && through.at(snapshot, 2, k, level) == stopped.at(snapshot, 2, k, level);
    CHECK(world.max(same ? 0 : 1) == 0);
}

TEST_CASE("strain and stress volumes are identical on any number of ranks", "[mpi]") {
    const Case c = recorded(GENERATE(from_range(test::cases_with_bodies())));
    const Comm world = Comm::world();
    test::VolumeStore together;
    engines::make_engine(c.solver)->run(c, world, together);
    const auto alone = test::frames_of_root<test::VolumeStore>(c, world);
    const auto start = static_cast<std::size_t>(together.slab().x_start * c.domain.ny);
    CHECK(world.max(static_cast<double>(together.planes())) ==
          static_cast<double>(2 * 15) * static_cast<double>(together.z_m().size()));
    for (std::size_t field = 0; field < 3; ++field) {
        test::Deviation difference;
        for (std::size_t snapshot = 0; snapshot < 2; ++snapshot)
            for (std::size_t k = 0; k < components_of(c.record.volume_fields[field]).size(); ++k)
                for (std::size_t level = 0; level < together.z_m().size(); ++level)
                    difference.add(together.at(snapshot, field, k, level),
                                   alone.at(snapshot, field, k, level), start);
        CAPTURE(field);
        // The sums of the iterations differ by rounding, which lambda/mu = 1e5 amplifies.
        CHECK(difference.relative(world) < 1e-9);
    }
}

} // namespace test_tensor_volumes
