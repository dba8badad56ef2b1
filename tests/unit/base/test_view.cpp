// SPDX-License-Identifier: BSD-3-Clause
#include "base/view.hpp"

#include <catch2/catch.hpp>
#include <numeric>
#include <type_traits>
#include <vector>

namespace test_view {

using namespace shearwake;

TEST_CASE("rows of a view are one stride apart", "[view]") {
    std::vector<double> values(12);
    std::iota(values.begin(), values.end(), 0.0);
    const View2<double> view(values.data(), 3, 2, 4);
    CHECK(view(0, 0) == 0.0);
    CHECK(view(1, 1) == 5.0);
    CHECK(view(2, 0) == 8.0);
    CHECK(view.row(1).size() == 2);
    view(2, 1) = -1.0;
    CHECK(values[9] == -1.0);
}

TEST_CASE("a view of values converts to a view of constants but not vice versa", "[view]") {
    std::vector<double> values = {1.0, 2.0};
    const View2<const double> view = View2<double>(values.data(), 1, 2);
    CHECK(view(0, 1) == 2.0);
    CHECK_FALSE(std::is_convertible_v<View2<const double>, View2<double>>);
}

} // namespace test_view
