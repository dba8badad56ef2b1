// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/stepper.hpp"
#include "support/pstd_sources.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>

namespace test_pstd_given {

using namespace shearwake;

TEST_CASE("Specified staggered materials and layer factors replace those of nodes and numbers",
          "[pstd]") {
    const Comm world = Comm::world();
    pstd::Setup derived;
    derived.grid = {{11, 9, 21}, {1e-3, 1.1e-3, 0.9e-3}, 5e-6};
    derived.pml = {.points = {2, 0, 4},
                   .strength_1 = {2.0, 1.0, 1.5},
                   .multi_axial_ratio_1 = 0.2,
                   .reference_speed_m_s = 20.0};
    derived.absorption = pstd::Absorption::kelvin_voigt;
    derived.material = [](pstd::Node n) {
        return pstd::NodeMaterial{1000.0 + static_cast<double>(7 * n[0] + n[2]), 20.0,
                                  n[1] < 4 ? 0.0 : 5.0 + 0.1 * static_cast<double>(n[2]), 0.01,
                                  n[1] < 4 ? 0.0 : 0.02};
    };
    pstd::Source source{.field = pstd::Field::sxz};
    source.nodes = {{2, 7, 12}, {10, 8, 20}, {5, 4, 9}};
    derived.sources.push_back(test::sampled_source(source, std::vector<double>(3 * 20, 2.0)));

    pstd::Setup given = derived;
    for (std::size_t a = 0; a < 3; ++a)
        for (const auto places : {pstd::PmlPlaces::nodes, pstd::PmlPlaces::half_a_cell_on})
            given.pml.given[a][static_cast<std::size_t>(places)] =
                pstd::pml_profile(derived.grid, derived.pml, a, places, 20.0);
    given.pml.strength_1 = {};
    pstd::StaggeredMaterial& staggered = given.staggered.emplace();
    constexpr std::size_t planes[3][2] = {{0, 1}, {0, 2}, {1, 2}};
    for (std::size_t i = 0; i < 3; ++i) {
        staggered.density_kg_m3[i] = [&, i](pstd::Node n) {
            return pstd::density_between(derived.grid, derived.material, n, i);
        };
        const auto mean = [&, i](double (*value)(const pstd::NodeMaterial&)) {
            return [&, i, value](pstd::Node n) {
                return pstd::harmonic_between(
                    derived.grid, [&](pstd::Node at) { return value(derived.material(at)); }, n,
                    planes[i][0], planes[i][1]);
            };
        };
        staggered.mu_Pa[i] = mean([](const pstd::NodeMaterial& m) { return m.mu_Pa(); });
        staggered.eta_Pa_s[i] = mean([](const pstd::NodeMaterial& m) { return m.eta_Pa_s; });
    }
    pstd::Stepper<double> first(derived, world), second(given, world);
    for (int n = 0; n < 40; ++n) {
        first.step();
        second.step();
    }
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const auto a = first.total(static_cast<pstd::Field>(f)),
                   b = second.total(static_cast<pstd::Field>(f));
        test::Deviation difference;
        difference.add(b, a);
        CHECK(difference.relative(world) == 0.0); // the same operations on the same numbers
    }

    // Without the given densities the fields differ: the arrays are used.
    staggered.density_kg_m3[0] = [](pstd::Node) { return 500.0; };
    pstd::Stepper<double> third(given, world);
    for (int n = 0; n < 40; ++n)
        third.step();
    test::Deviation difference;
    difference.add(third.total(pstd::Field::ux), first.total(pstd::Field::ux));
    CHECK(difference.relative(world) > 0.0);
}

} // namespace test_pstd_given
