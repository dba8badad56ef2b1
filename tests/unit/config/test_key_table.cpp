// SPDX-License-Identifier: BSD-3-Clause
#include "config/keys/key_table.hpp"

#include <catch2/catch.hpp>

namespace test_key_table {

using namespace shearwake;
using namespace shearwake::config;

TEST_CASE("the reference has ranges and defaults in the units of the keys", "[fields]") {
    const std::string text = key_reference();
    for (const char* row :
         {"| `silence_ms` | 0 or between 1e-09 and 10000 | 20 |",
          "| `footprint.distance_mm` | between 20 and",
          "| `top` | `\"void\"`, `\"continued\"`, `\"fluid\"` | `\"void\"` |",
          "## `[[load.modulation.envelope]]` with `shape = \"square\"`", "## `[solver.pstd]`",
          "with `load = \"displacement\"`: displacement of the skin"})
        CHECK_THAT(text, Catch::Contains(row));
}

} // namespace test_key_table
