// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/bootstrap.hpp"

#include "base/constants.hpp"
#include "sampling/random.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::reduce {
namespace {

constexpr std::uint64_t seed = 20100211;
constexpr double confidence = 0.95;

Weights drawn(std::size_t n, std::uint32_t replicate) {
    Weights weights(n, 0.0);
    for (std::size_t draw = 0; draw < n; ++draw)
        weights[sampling::random_bits(seed, replicate, draw) % n] += 1.0;
    return weights;
}

/// The value at the fraction `p` of ascending values, interpolated linearly.
double at_fraction(const std::vector<double>& ascending, double p) {
    const double place = p * static_cast<double>(ascending.size() - 1);
    const auto i = static_cast<std::size_t>(place);
    const std::size_t next = std::min(i + 1, ascending.size() - 1);
    return std::lerp(ascending[i], ascending[next], place - static_cast<double>(i));
}

} // namespace

std::vector<Estimate> bootstrap(std::size_t n, const std::vector<std::string>& names,
                                const std::function<std::vector<double>(const Weights&)>& statistic,
                                std::size_t replicates) {
    std::vector<Estimate> estimates;
    if (n == 0) {
        for (const std::string& name : names)
            estimates.push_back({name, not_a_number, not_a_number, not_a_number});
        return estimates;
    }
    std::vector<std::vector<double>> replicated(names.size());
    for (std::size_t r = 0; r < replicates; ++r) {
        const std::vector<double> values = statistic(drawn(n, static_cast<std::uint32_t>(r)));
        for (std::size_t i = 0; i < names.size(); ++i)
            if (std::isfinite(values[i])) replicated[i].push_back(values[i]);
    }
    const std::vector<double> values = statistic(Weights(n, 1.0));
    for (std::size_t i = 0; i < names.size(); ++i) {
        std::ranges::sort(replicated[i]);
        const bool known = std::isfinite(values[i]) && !replicated[i].empty();
        const auto end = [&](double p) {
            return known ? at_fraction(replicated[i], p) : not_a_number;
        };
        estimates.push_back({names[i], known ? values[i] : not_a_number,
                             end(0.5 - confidence / 2.0), end(0.5 + confidence / 2.0)});
    }
    return estimates;
}

} // namespace shearwake::reduce
