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

} // namespace test_pml
