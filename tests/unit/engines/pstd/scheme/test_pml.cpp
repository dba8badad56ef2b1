// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/pml.hpp"

#include <catch2/catch.hpp>

namespace test_pml {

using namespace shearwake;

TEST_CASE("the planned sizes of the parts of a field are those of its runs", "[pstd]") {
    const bool has_gap = GENERATE(false, true); // between the layers of z, at least 32 nodes wide
    const pstd::Grid grid{{37, 26, has_gap ? 60 : 40}, {}, 0.0};
    pstd::PmlOptions options{.points = {5, 4, 6}};
    const int ranks = 3, rank = GENERATE(0, 1, 2);
    if (rank == 1) options.strength_1[1] = 0.0;
    const pstd::Slabs slabs = pstd::slabs_of(grid, ranks, rank);
    for (std::size_t f = 0; f < pstd::field_count; ++f) {
        const pstd::Parts parts = pstd::parts_of(static_cast<pstd::Field>(f));
        const pstd::SplitRuns runs(slabs, options, parts, {});
        CHECK(pstd::split_sizes(slabs, options, parts).values ==
              static_cast<double>(runs.size(0) + runs.size(1)));
    }
}

TEST_CASE("the layers on both sides of an axis are mirror images", "[pstd]") {
    const std::size_t n = 24;
    const pstd::Grid grid{{24, 8, 8}, {1e-3, 1e-3, 1e-3}, 1e-5};
    const pstd::PmlOptions options{.points = {5, 0, 0}};
    for (const auto places : {pstd::PmlPlaces::nodes, pstd::PmlPlaces::half_a_cell_on}) {
        // Half a cell above the last node of a grid is half a cell below the first one.
        const std::size_t last = places == pstd::PmlPlaces::nodes ? n - 1 : n - 2;
        const pstd::PmlProfile profile = pstd::pml_profile(grid, options, 0, places, 20.0);
        CHECK(profile.main[0] < 1.0);
        // The half cell between the layer and the node above it belongs to the lower layer alone.
        for (std::size_t i = 0; i < 4; ++i)
            CHECK(profile.main[i] == profile.main[last - i]);
    }
}

} // namespace test_pml
