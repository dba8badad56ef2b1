// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "engines/pstd/scheme/source.hpp"

#include <fmt/format.h>

namespace shearwake::test {

constexpr bool is_shear(pstd::Field field) {
    return pstd::index_of(field) >= 6;
}

/// Samples are pattern[node] * series[sample]. Throws Error if the sizes do not match.
inline pstd::Source separable_source(pstd::Source source, std::vector<double> pattern,
                                     std::vector<double> series) {
    if (pattern.size() != source.nodes.size())
        throw Error(fmt::format("the pattern of a source has {} values for {} nodes",
                                pattern.size(), source.nodes.size()));
    source.samples = std::ssize(series);
    source.values = [pattern = std::move(pattern), series = std::move(series)](
                        std::ptrdiff_t sample, std::span<const std::size_t> which,
                        std::span<double> values) {
        const double now = series[static_cast<std::size_t>(sample)];
        for (std::size_t i = 0; i < which.size(); ++i)
            values[i] = pattern[which[i]] * now;
    };
    return source;
}

/// Samples are samples[node][sample], row-major. Throws Error if the sizes do not match.
inline pstd::Source sampled_source(pstd::Source source, std::vector<double> samples) {
    const std::size_t nodes = source.nodes.size();
    if (nodes == 0 || samples.size() % nodes != 0)
        throw Error(fmt::format("the {} values of a source are not a multiple of its {} nodes",
                                samples.size(), nodes));
    const std::size_t length = samples.size() / nodes;
    source.samples = static_cast<std::ptrdiff_t>(length);
    source.values = [length, samples = std::move(samples)](std::ptrdiff_t sample,
                                                           std::span<const std::size_t> which,
                                                           std::span<double> values) {
        for (std::size_t i = 0; i < which.size(); ++i)
            values[i] = samples[which[i] * length + static_cast<std::size_t>(sample)];
    };
    return source;
}

} // namespace shearwake::test
