// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/skyline_matrix.hpp"

#include <algorithm>

namespace shearwake::spectral {

SkylineMatrix::SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree,
                             std::ptrdiff_t per_level) {
    for (std::ptrdiff_t level = 0; level < levels; ++level) {
        const std::ptrdiff_t element = std::max<std::ptrdiff_t>(level - 1, 0) / degree;
        for (std::ptrdiff_t i = 0; i < per_level; ++i) {
            const std::ptrdiff_t first = element * degree * per_level;
            rows_.push_back({first, entries_ - first});
            entries_ += level * per_level + i - first + 1;
        }
    }
}

} // namespace shearwake::spectral
