// SPDX-License-Identifier: BSD-3-Clause
#include "reduce/derived_tables.hpp"

#include "base/units.hpp"
#include "sampling/design.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <numeric>

namespace shearwake::reduce {

namespace {

constexpr std::array fractions = {0.05, 0.25, 0.5, 0.75, 0.95};

struct Moments {
    double mean = 0.0, variance = 0.0;
};

Moments moments(const std::vector<double>& values, const Weights& weights) {
    double n = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = 0; i < values.size(); ++i) {
        n += weights[i];
        sum += weights[i] * values[i];
    }
    const double mean = sum / n;
    for (std::size_t i = 0; i < values.size(); ++i)
        squares += weights[i] * (values[i] - mean) * (values[i] - mean);
    return {mean, n > 1.0 ? squares / (n - 1.0) : not_a_number};
}

/// Quantiles of ascending values with weights, interpolated as in NumPy's default.
void add_quantiles(const std::vector<double>& ascending, const Weights& weights,
                   std::vector<double>& out) {
    const double n = std::accumulate(weights.begin(), weights.end(), 0.0);
    std::size_t i = 0;
    double through = weights[0]; // number of draws up to and including value i
    for (const double p : fractions) {
        const double place = p * (n - 1.0), lower = std::floor(place);
        while (through <= lower)
            through += weights[++i];
        std::size_t next = i;
        for (double reached = through; reached <= lower + 1.0 && next + 1 < ascending.size();)
            reached += weights[++next];
        out.push_back(std::lerp(ascending[i], ascending[next], place - lower));
    }
}

/// Weighted sums over blocks with values `a`, `b` and `mixed` (a with one coordinate of b), from
/// which a common mean has been subtracted.
struct PairSums {
    double both = 0.0, product = 0.0, squares = 0.0, jansen = 0.0;

    void add(double weight, double a, double b, double mixed) {
        both += weight * (b + mixed) / 2.0;
        product += weight * b * mixed;
        squares += weight * (b * b + mixed * mixed) / 2.0;
        jansen += weight * (a - mixed) * (a - mixed) / 2.0;
    }
    /// The correlation of b and mixed, which share one coordinate: the first-order index.
    double correlation(double n) const {
        const double squared_mean = both / n * (both / n);
        return (product / n - squared_mean) / (squares / n - squared_mean);
    }
};

} // namespace

namespace {

/// Replaces the bootstrap interval of a probability, which has no width at 0 and 1, by that of
/// Wilson for a share of n values (J. Am. Stat. Assoc. 22, 209, 1927).
void set_wilson_interval(Estimate& probability, double n) {
    constexpr double z = 1.959964; // the 97.5 % quantile of the normal distribution
    const double p = probability.value;
    const double middle = p + z * z / (2.0 * n);
    const double half = z * std::sqrt(p * (1.0 - p) / n + z * z / (4.0 * n * n));
    probability.low = p > 0.0 ? (middle - half) / (1.0 + z * z / n) : 0.0; // exact at the ends
    probability.high = p < 1.0 ? (middle + half) / (1.0 + z * z / n) : 1.0;
}

} // namespace

std::vector<Estimate> distribution_of(std::vector<double> values,
                                      const std::vector<double>& thresholds) {
    std::ranges::sort(values);
    std::vector<std::string> names = {"mean", "sd", "q05", "q25", "q50", "q75", "q95"};
    for (const double threshold : thresholds)
        names.push_back(fmt::format("exceeds {:.9g}", threshold));
    std::vector<Estimate> found = bootstrap(values.size(), names, [&](const Weights& weights) {
        const Moments m = moments(values, weights);
        std::vector<double> out = {m.mean, std::sqrt(m.variance)};
        add_quantiles(values, weights, out);
        for (const double threshold : thresholds) {
            double above = 0.0, all = 0.0;
            for (std::size_t i = 0; i < values.size(); ++i) {
                all += weights[i];
                above += values[i] > threshold ? weights[i] : 0.0;
            }
            out.push_back(above / all);
        }
        return out;
    });
    if (!values.empty())
        for (auto e = found.end() - std::ssize(thresholds); e != found.end(); ++e)
            set_wilson_interval(*e, static_cast<double>(values.size()));
    return found;
}

std::vector<Estimate> sobol_indices(const Blocks& blocks, std::size_t keys) {
    std::vector<std::string> names;
    for (std::size_t k = 0; k < keys; ++k)
        names.insert(names.end(), {"first_order", "total"});
    return bootstrap(blocks.size(), names, [&](const Weights& weights) {
        double n = 0.0, mean = 0.0, variance = 0.0;
        for (std::size_t j = 0; j < blocks.size(); ++j) {
            n += weights[j];
            mean += weights[j] * (blocks[j][0] + blocks[j][1]) / 2.0;
        }
        mean /= n;
        std::vector<PairSums> sums(keys);
        for (std::size_t j = 0; j < blocks.size(); ++j) {
            const double w = weights[j], a = blocks[j][0] - mean, b = blocks[j][1] - mean;
            variance += w * (a * a + b * b) / 2.0;
            for (std::size_t k = 0; k < keys; ++k)
                sums[k].add(w, a, b, blocks[j][2 + k] - mean);
        }
        variance /= n;
        const bool varies = variance > 1e-24 * mean * mean; // above the rounding of the values
        std::vector<double> indices;
        for (const PairSums& s : sums) {
            indices.push_back(varies ? s.correlation(n) : not_a_number);
            indices.push_back(varies ? s.jansen / n / variance : not_a_number);
        }
        return indices;
    });
}

std::vector<Estimate> morris_measures(const Blocks& blocks,
                                      const std::vector<std::vector<std::vector<double>>>& points,
                                      std::size_t keys) {
    std::vector<std::string> names;
    std::vector<std::vector<double>> effects(keys);
    for (std::size_t k = 0; k < keys; ++k) {
        names.insert(names.end(), {"mu", "mu_star", "sigma"});
        for (std::size_t j = 0; j < blocks.size(); ++j)
            effects[k].push_back((blocks[j][1 + k] - blocks[j][0]) /
                                 (points[j][1 + k][k] - points[j][0][k]));
    }
    return bootstrap(blocks.size(), names, [&](const Weights& weights) {
        std::vector<double> out;
        for (const std::vector<double>& effect : effects) {
            std::vector<double> magnitudes(effect.size());
            std::ranges::transform(effect, magnitudes.begin(),
                                   [](double e) { return std::abs(e); });
            const Moments m = moments(effect, weights);
            out.insert(out.end(),
                       {m.mean, moments(magnitudes, weights).mean, std::sqrt(m.variance)});
        }
        return out;
    });
}

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
