// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/stepper.hpp"
#include "storage/checkpoint/checkpoint_file.hpp"
#include "support/pstd_sources.hpp"
#include "support/shared_folder.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>

namespace test_pstd_checkpoint {

using namespace shearwake;
using namespace shearwake::pstd;

constexpr std::ptrdiff_t before = 25, after = 25; // steps
const storage::CheckpointOwner owner{"case", "program"};

/// Layers of fluid and of a lossy solid with a body, absorbing layers on some sides only, a
/// prescribed velocity in the middle and an additive stress: everything that a checkpoint must
/// contain. The extents have no common divisors with the number of ranks.
static pstd::Setup everything() {
    pstd::Setup s;
    s.grid = {{11, 9, 21}, {1e-3, 1.1e-3, 0.9e-3}, 5e-6};
    s.pml.points = {2, 0, 4};
    s.absorption = pstd::Absorption::kelvin_voigt;
    s.material = [](pstd::Node n) {
        if (n[2] < 6) return pstd::NodeMaterial{1000.0, 15.0, 0.0};
        const bool body = n[0] > 3 && n[0] < 8 && n[1] > 2 && n[1] < 6 && n[2] > 10;
        return pstd::NodeMaterial{1100.0, 20.0, body ? 9.0 : 5.0, 0.01, 0.02};
    };
    pstd::Source prescribed{.field = pstd::Field::uz, .mode = pstd::SourceMode::dirichlet};
    prescribed.nodes = {{5, 4, 9}, {6, 4, 9}, {0, 0, 0}};
    s.sources.push_back(
        test::sampled_source(prescribed, std::vector<double>(3 * (before + 10), 1e-3)));
    pstd::Source put_in{.field = pstd::Field::sxz};
    put_in.nodes = {{2, 7, 12}, {10, 8, 20}};
    s.sources.push_back(test::sampled_source(put_in, std::vector<double>(2 * (before + 10), 2.0)));
    return s;
}

/// Largest difference of the totals at the same nodes relative to the largest value, maximum over
/// the fields. Infinite if a field is zero everywhere.
template <class Real>
double apart(const pstd::Stepper<Real>& here, const pstd::Stepper<Real>& whole, const Comm& world) {
    double worst = 0.0;
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const auto got = here.total(static_cast<pstd::Field>(f)),
                   expected = whole.total(static_cast<pstd::Field>(f));
        const auto shift = static_cast<std::size_t>(here.slabs().x_start() * here.slabs().ny() *
                                                    here.slabs().pitch);
        worst = test::worse(worst, test::apart(got, expected, shift));
    }
    return world.max(worst);
}

template <class Real>
void advance(pstd::Stepper<Real>& stepper, std::ptrdiff_t steps) {
    for (std::ptrdiff_t n = 0; n < steps; ++n)
        stepper.step();
}

template <class Real>
void save(const pstd::Stepper<Real>& stepper, const std::filesystem::path& path, const Comm& team) {
    storage::CheckpointFileWriter file(path, team);
    stepper.save(file);
    file.commit(owner, {.sequence = 1});
}

template <class Real>
void restore(pstd::Stepper<Real>& stepper, const std::filesystem::path& path, const Comm& team) {
    const storage::CheckpointFileReader file(path, team);
    stepper.restore(file);
}

TEMPLATE_TEST_CASE(
    "engine pstd resumes from a checkpoint with the same bits on any number of ranks",
    "[mpi][pstd]", double, float) {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const test::SharedFolder folder(world);
    const pstd::Setup setup = everything();
    pstd::Stepper<TestType> whole(setup, alone), unbroken(setup, world);
    advance(whole, before);
    advance(unbroken, before);
    if (world.is_root()) save(whole, folder.file("one.h5"), alone);
    save(unbroken, folder.file("team.h5"), world);

    pstd::Stepper<TestType> from_one(setup, world), from_team(setup, world),
        alone_from_team(setup, alone);
    restore(from_one, folder.file("one.h5"), world);
    restore(from_team, folder.file("team.h5"), world);
    restore(alone_from_team, folder.file("team.h5"), alone);
    const bool counted = from_one.steps() == before && from_team.steps() == before;
    CHECK(counted);
    for (pstd::Stepper<TestType>* s : {&whole, &unbroken, &from_one, &from_team, &alone_from_team})
        advance(*s, after);
    // Exactly equal: every line uses the same plan, and sums run along lines only.
    const double same = apart(from_team, whole, world), other = apart(from_one, whole, world),
                 on_one = apart(alone_from_team, whole, world),
                 ranks = apart(unbroken, whole, world);
    CHECK(same == 0.0);
    CHECK(other == 0.0);
    CHECK(on_one == 0.0);
    CHECK(ranks == 0.0);
}

} // namespace test_pstd_checkpoint
