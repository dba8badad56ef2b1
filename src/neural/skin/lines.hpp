// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Time series of equal length, one per pin or one per afferent.
struct Lines {
    std::size_t count = 0, samples = 0;
    std::vector<double> values; // line by line

    Lines() = default;
    Lines(std::size_t lines, std::size_t samples_a_line)
        : count(lines), samples(samples_a_line), values(lines * samples_a_line) {}
    bool operator==(const Lines&) const = default;

    std::span<double> line(std::size_t i) {
        return std::span(values).subspan(i * samples, samples);
    }
    std::span<const double> line(std::size_t i) const {
        return std::span(values).subspan(i * samples, samples);
    }
};

} // namespace shearwake::neural
