// SPDX-License-Identifier: BSD-3-Clause
#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "pipeline/afferent_result.hpp"

#include <catch2/catch.hpp>
#include <set>

namespace test_work {

using namespace shearwake;

namespace {

constexpr engines::WorkKind of_point = {"point", 1e-9}, of_frame = {"frame", 1e-3};

bool contains(const std::vector<engines::Work>& work, const std::string& kind) {
    for (const engines::Work& part : work)
        if (part.kind.name == kind) return part.amount > 0.0;
    return false;
}

} // namespace

TEST_CASE("time is the amount of work times the measured rate or else the assumed rate", "[work]") {
    const std::vector<engines::Work> work = {{of_point, 1e6}, {of_frame, 10.0}};
    CHECK(engines::time_s(work, {}) == Approx(1e-3 + 1e-2));
    CHECK(engines::time_s(work, {{"point", 3e-9}}) == Approx(3e-3 + 1e-2));
}

TEST_CASE("solves the rates from cases with several kinds of work", "[work]") {
    const engines::Rates truth = {{"point", 4e-9}, {"frame", 2e-3}};
    const std::vector<engines::Work> points = {{of_point, 1e7}, {of_frame, 1.0}},
                                     frames = {{of_point, 1e6}, {of_frame, 20.0}};
    const engines::Rates found =
        engines::solve_rates({{"point", points, engines::time_s(points, truth)},
                              {"frame", frames, engines::time_s(frames, truth)}},
                             {});
    CHECK(found.at("point") == Approx(4e-9));
    CHECK(found.at("frame") == Approx(2e-3));
}

TEST_CASE("limits the rate of a noisy measurement to a quarter of the usual rate", "[work]") {
    // The machine is three times slower than assumed, but the case of frames seems to take no time.
    const engines::Rates found = engines::solve_rates(
        {{"point", {{of_point, 1e7}}, 3e-2}, {"frame", {{of_point, 1e9}, {of_frame, 1.0}}, 1e-6}},
        {});
    CHECK(found.at("point") == Approx(3e-9));
    CHECK(found.at("frame") == Approx(0.75e-3));
}

TEST_CASE("each calibration case contains the work that it measures", "[work]") {
    std::vector<engines::Calibration> all = pipeline::receptor_calibrations();
    for (const SolverOptions& solver :
         {SolverOptions(LayeredOptions{}), SolverOptions(SpectralOptions{}),
          SolverOptions(PstdOptions{})}) {
        const auto more = engines::make_engine(solver)->calibrations();
        all.insert(all.end(), more.begin(), more.end());
    }
    std::set<std::string> kinds = {engines::of_fresh_memory.name};
    for (const engines::Calibration& one : all) {
        CAPTURE(one.kind);
        CHECK(kinds.insert(one.kind).second);
        const engines::Estimate e =
            engines::make_engine(one.physics.solver)->estimate(one.physics, 1);
        CHECK((contains(e.work, one.kind) || contains(e.shared, one.kind) ||
               contains(pipeline::receptors_work(one.physics), one.kind)));
        CHECK(e.memory_per_rank_B < 300e6);
    }
    // All other kinds of work in these cases can be measured, too.
    for (const engines::Calibration& one : all)
        for (const engines::Work& part :
             engines::make_engine(one.physics.solver)->estimate(one.physics, 1).work) {
            CAPTURE(one.kind, part.kind.name);
            CHECK(kinds.contains(part.kind.name));
        }
}

TEST_CASE("the share limited by memory grows from 0 to 1", "[work]") {
    CHECK(engines::share_from_memory(1e5) == 0.0);
    CHECK(engines::share_from_memory(1e9) == 1.0);
    CHECK(engines::share_from_memory(1e7) > 0.2);
    CHECK(engines::share_from_memory(1e7) < engines::share_from_memory(2e7));
}

} // namespace test_work
