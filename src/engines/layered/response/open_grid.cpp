// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/open_grid.hpp"

#include <cmath>

namespace shearwake::layered {

double open_reach_m(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m) {
    return spacing_m * std::hypot(nx / 2, ny / 2);
}

} // namespace shearwake::layered
