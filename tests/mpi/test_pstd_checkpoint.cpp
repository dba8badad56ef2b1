#include "engines/pstd/stepper.hpp"
#include "support/checkpoint_state.hpp"
#include "support/shared_folder.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace shearwake;
using namespace shearwake::pstd;

namespace {

constexpr std::ptrdiff_t before = 25, after = 25; // steps
const CheckpointOwner owner{"case", "program"};

/// Layers of fluid and of a lossy solid with a body, a layer on some sides alone, a velocity held
/// in the middle and a stress put in: whatever a state must keep. Extents that divide by nothing.
Setup everything() {
    Setup s;
    s.grid = {{11, 9, 21}, {1e-3, 1.1e-3, 0.9e-3}, 5e-6};
    s.pml.points = {2, 0, 4};
    s.absorption = Absorption::kelvin_voigt;
    s.material = [](Node n) {
        if (n[2] < 6) return NodeMaterial{1000.0, 15.0, 0.0};
        const bool body = n[0] > 3 && n[0] < 8 && n[1] > 2 && n[1] < 6 && n[2] > 10;
        return NodeMaterial{1100.0, 20.0, body ? 9.0 : 5.0, 0.01, 0.02};
    };
    Source held{.field = Field::uz, .mode = SourceMode::dirichlet};
    held.nodes = {{5, 4, 9}, {6, 4, 9}, {0, 0, 0}};
    s.sources.push_back(sampled_source(held, std::vector<double>(3 * (before + 10), 1e-3)));
    Source put_in{.field = Field::sxz};
    put_in.nodes = {{2, 7, 12}, {10, 8, 20}};
    s.sources.push_back(sampled_source(put_in, std::vector<double>(2 * (before + 10), 2.0)));
    return s;
}

/// Largest difference of totals at the same nodes over the largest value; of each field, the worst.
/// Infinite where a field is zero everywhere.
template <class Real>
double apart(const Stepper<Real>& here, const Stepper<Real>& whole, const Comm& world) {
    double worst = 0.0;
    for (std::size_t f = 0; f < field_count; ++f) {
        const auto got = here.total(static_cast<Field>(f)),
                   expected = whole.total(static_cast<Field>(f));
        const auto shift = static_cast<std::size_t>(here.slabs().x_start() * here.slabs().ny() *
                                                    here.slabs().pitch);
        double largest = 0.0, differs = 0.0;
        for (const Real v : expected)
            largest = test::worse(largest, std::abs(static_cast<double>(v)));
        for (std::size_t i = 0; i < got.size(); ++i)
            differs =
                test::worse(differs, std::abs(static_cast<double>(got[i] - expected[i + shift])));
        worst = test::worse(worst, differs / largest);
    }
    return world.max(worst);
}

template <class Real>
void advance(Stepper<Real>& stepper, std::ptrdiff_t steps) {
    for (std::ptrdiff_t n = 0; n < steps; ++n)
        stepper.step();
}

template <class Real>
void save(const Stepper<Real>& stepper, const std::filesystem::path& path, const Comm& team) {
    CheckpointFileWriter file(path, team);
    test::StateToFile state(file);
    stepper.save(state);
    file.commit(owner, {.sequence = 1});
}

template <class Real>
void restore(Stepper<Real>& stepper, const std::filesystem::path& path, const Comm& team) {
    const CheckpointFileReader file(path, team);
    test::StateFromFile state(file);
    stepper.restore(state);
}

} // namespace

TEMPLATE_TEST_CASE("pstd goes on from a state as if it had not stopped, on any number of ranks",
                   "[mpi][pstd]", double, float) {
    const Comm world = Comm::world(), alone = world.split(world.rank());
    const test::SharedFolder folder(world);
    const Setup setup = everything();
    Stepper<TestType> whole(setup, alone), unbroken(setup, world);
    advance(whole, before);
    advance(unbroken, before);
    if (world.is_root()) save(whole, folder.file("one.h5"), alone);
    save(unbroken, folder.file("team.h5"), world);

    Stepper<TestType> from_one(setup, world), from_team(setup, world),
        alone_from_team(setup, alone);
    restore(from_one, folder.file("one.h5"), world);
    restore(from_team, folder.file("team.h5"), world);
    restore(alone_from_team, folder.file("team.h5"), alone);
    const bool counted = from_one.steps() == before && from_team.steps() == before;
    CHECK(counted);
    for (Stepper<TestType>* s : {&whole, &unbroken, &from_one, &from_team, &alone_from_team})
        advance(*s, after);
    // Exactly: every line has the same plan wherever it is, and nothing but lines' own order sums.
    const double same = apart(from_team, whole, world), other = apart(from_one, whole, world),
                 on_one = apart(alone_from_team, whole, world),
                 ranks = apart(unbroken, whole, world);
    CHECK(same == 0.0);
    CHECK(other == 0.0);
    CHECK(on_one == 0.0);
    CHECK(ranks == 0.0);
}
