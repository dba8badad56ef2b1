// SPDX-License-Identifier: BSD-3-Clause
#include "neural/fibre/noise.hpp"

#include "base/constants.hpp"

#include <cmath>
#include <Random123/philox.h>
#include <Random123/uniform.hpp>

namespace shearwake::neural {

std::array<double, 2> two_uniforms(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto low = [](std::uint64_t v) { return static_cast<std::uint32_t>(v); };
    const r123::Philox4x32::ctr_type at = {{low(counter), low(counter >> 32), stream, 0}};
    const r123::Philox4x32::key_type with = {{low(key), low(key >> 32)}};
    const auto bits = r123::Philox4x32{}(at, with);
    const auto word = [&](std::size_t i) {
        return static_cast<std::uint64_t>(bits[i + 1]) << 32 | bits[i];
    };
    return {r123::u01<double>(word(0)), r123::u01<double>(word(2))};
}

std::array<double, 2> two_normals(std::uint64_t key, std::uint32_t stream, std::uint64_t counter) {
    const auto [u, v] = two_uniforms(key, stream, counter);
    const double radius = std::sqrt(-2.0 * std::log(u)), angle = two_pi * v;
    return {radius * std::cos(angle), radius * std::sin(angle)};
}

} // namespace shearwake::neural
