// SPDX-License-Identifier: BSD-3-Clause
// A diverging field ends the case on all ranks together, with the step and a hint.
#include "base/error.hpp"
#include "engines/spectral/stepping/stepper.hpp"
#include "engines/spectral/stepping/time_step.hpp"
#include "support/cases.hpp"
#include "support/memory_state.hpp"

#include <catch2/catch.hpp>
#include <limits>

namespace test_energy_watch {

using namespace shearwake;

static Case small_case(bool body) {
    Case c = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    c.scene.medium.base = Base::rigid;
    c.scene.medium.layers[0].thickness_m = 8e-3;
    if (body)
        c.scene.medium.bodies = {{.name = "body",
                                  .shape = Ellipsoid{{5e-3, 4e-3, 2e-3}},
                                  .centre_m = {1e-3, 2e-3, 4e-3},
                                  .density_kg_m3 = 1300.0}};
    c.domain = {24, 18, 1.5e-3, 0.0};
    c.time = {100, 100e-6};
    c.solver = SpectralOptions{.time_step_s = 100e-6};
    return c;
}

/// The message of a run that continues for 40 steps from a checkpoint modified by `spoil`.
template <class Spoil>
std::string failure(const Case& c, const Spoil& spoil) {
    const Comm world = Comm::world();
    const fft::SlabTransform slabs(c.domain.nx, c.domain.ny, world);
    const spectral::DepthMesh mesh = spectral::choose_mesh(c, std::get<SpectralOptions>(c.solver));
    spectral::Stepper stepper(c, mesh, slabs, 100e-6, world);
    for (int i = 0; i < 20; ++i)
        stepper.advance();
    test::MemoryState state;
    stepper.save(state);
    spoil(state);
    stepper.restore(state);
    try {
        for (int i = 0; i < 40; ++i)
            stepper.advance();
    } catch (const FieldDiverges& failure) {
        return failure.what();
    }
    return "no failure";
}

/// Number of ranks whose message contains all of these texts.
static int ranks_that_report(const std::string& said, std::initializer_list<const char*> words) {
    double found = 1.0;
    for (const char* word : words)
        if (said.find(word) == std::string::npos) found = 0.0;
    return static_cast<int>(Comm::world().sum(found));
}

TEST_CASE("throws on all ranks if one rank has a value that is not a number", "[mpi]") {
    const bool body = GENERATE(false, true);
    const int bad_rank = Comm::world().size() - 1;
    const std::string said = failure(small_case(body), [&](test::MemoryState& state) {
        // kx = 0 of the first row, a wave vector that every rank with rows has.
        if (Comm::world().rank() == bad_rank && !state.rows("now").empty())
            state.rows("now")[1] = std::numeric_limits<double>::quiet_NaN();
    });
    CAPTURE(body, said);
    CHECK(ranks_that_report(said, {"step ", " ms: the field is not finite", "time_step_us",
                                   "contrast_cap", "residual"}) == Comm::world().size());
}

TEST_CASE("throws if the kinetic energy exceeds the work of the load", "[mpi]") {
    const bool body = GENERATE(false, true);
    const std::string said = failure(small_case(body), [&](test::MemoryState& state) {
        for (double& u : state.rows("now"))
            u *= 100.0;
    });
    CAPTURE(body, said);
    CHECK(ranks_that_report(said, {"step ", " ms: the field diverges: its kinetic energy is ",
                                   "time_step_us", "contrast_cap"}) == Comm::world().size());
}

TEST_CASE("does not interrupt a stable run", "[mpi]") {
    const bool body = GENERATE(false, true);
    CHECK(failure(small_case(body), [](test::MemoryState&) {}) == "no failure");
}

} // namespace test_energy_watch
