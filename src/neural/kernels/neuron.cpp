// SPDX-License-Identifier: BSD-3-Clause
#include "neural/kernels/neuron.hpp"

#include "simd/kernels.hpp"
#include "simd/vector.hpp"

namespace shearwake::neural {
namespace {

using namespace simd;

constexpr std::ptrdiff_t slices = lane_count / width;

[[gnu::always_inline]] inline Vector get(const Block& block, std::ptrdiff_t s) {
    return load_aligned(block.lane + s * width);
}
[[gnu::always_inline]] inline void set(Block& block, std::ptrdiff_t s, Vector v) {
    store_aligned(v, block.lane + s * width);
}
/// max(v, 0) and max(-v, 0).
[[gnu::always_inline]] inline Vector positive_part(Vector v) {
    return v > 0.0 ? v : Vector{};
}
[[gnu::always_inline]] inline Vector negative_part(Vector v) {
    return v < 0.0 ? -v : Vector{};
}

/// Number of samples that stay in registers while all lines are added to them.
constexpr std::ptrdiff_t chunk = 8 * width;

void sum_delayed(const DelayedLine* lines, std::ptrdiff_t count, std::ptrdiff_t samples,
                 double* sum) {
    for (std::ptrdiff_t at = 0; at < samples; at += chunk) {
        const std::ptrdiff_t length = at + chunk <= samples ? chunk : samples - at;
        double rest[chunk] = {}; // at the start of a line or the end of all lines
        Vector all[chunk / width] = {};
        for (std::ptrdiff_t l = 0; l < count; ++l) {
            const DelayedLine& line = lines[l];
            if (line.delay >= at + length) continue;
            const double* from = line.values + at - line.delay;
            if (line.delay <= at && length == chunk) {
                const Vector gain = all_lanes(line.gain);
                for (std::ptrdiff_t v = 0; v < chunk / width; ++v)
                    all[v] += gain * load(from + v * width);
                continue;
            }
            for (std::ptrdiff_t k = line.delay > at ? line.delay - at : 0; k < length; ++k)
                rest[k] += line.gain * from[k];
        }
        if (length == chunk)
            for (std::ptrdiff_t v = 0; v < chunk / width; ++v)
                store(all[v] + load(rest + v * width), sum + at + v * width);
        else
            for (std::ptrdiff_t k = 0; k < length; ++k)
                sum[at + k] = rest[k];
    }
}

/// Transposed direct form II.
void low_pass(const LowPass& filter, std::ptrdiff_t samples, Block* line) {
    Vector state1[slices] = {}, state2[slices] = {}, state3[slices] = {};
    for (std::ptrdiff_t k = 0; k < samples; ++k)
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector in = get(filter.b, s) * get(line[k], s);
            const Vector out = in + state1[s];
            state1[s] = 3.0 * in - get(filter.a1, s) * out + state2[s];
            state2[s] = 3.0 * in - get(filter.a2, s) * out + state3[s];
            state3[s] = in - get(filter.a3, s) * out;
            set(line[k], s, out);
        }
}

void current(const CurrentWeights& weights, std::ptrdiff_t samples, const Block* stress, Block* d) {
    for (std::ptrdiff_t k = 0; k < samples; ++k)
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector rate = get(d[k], s);
            const Vector jerk = k + 1 < samples ? get(d[k + 1], s) - rate : Vector{};
            Vector I = get(weights.rate_positive, s) * positive_part(rate) +
                       get(weights.rate_negative, s) * negative_part(rate) +
                       get(weights.jerk_positive, s) * positive_part(jerk) +
                       get(weights.jerk_negative, s) * negative_part(jerk);
            if (stress)
                I += get(weights.static_positive, s) * positive_part(get(stress[k], s)) +
                     get(weights.static_negative, s) * negative_part(get(stress[k], s));
            set(d[k], s, I);
        }
}

void saturate(const Block& saturation, std::ptrdiff_t samples, Block* current) {
    for (std::ptrdiff_t k = 0; k < samples; ++k)
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector m = get(saturation, s), I = get(current[k], s);
            set(current[k], s, m > 0.0 ? m * I / (m + magnitude(I)) : I);
        }
}

void integrate_and_fire(const Block& membrane_samples, const Block* after_spike,
                        std::ptrdiff_t longest, std::ptrdiff_t samples, const Block* current,
                        unsigned char* fired) {
    std::ptrdiff_t since[lane_count]; // samples since the last spike
    for (std::ptrdiff_t& lane : since)
        lane = longest;
    Block V{}, after;
    for (std::ptrdiff_t k = 0; k < samples; ++k) {
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
            after[lane] = after_spike[since[lane]][lane];
            since[lane] += since[lane] < longest;
        }
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Vector v = get(V, s);
            set(V, s, v + (-v / get(membrane_samples, s) + get(current[k], s) + get(after, s)));
        }
        unsigned char spikes = 0;
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            if (V[lane] > 1.0 && since[lane] >= shortest_interval) {
                spikes = static_cast<unsigned char>(spikes | 1u << lane);
                V[lane] = 0.0;
                since[lane] = 0;
            }
        fired[k] = spikes;
    }
}

constexpr NeuronKernels table = {sum_delayed, low_pass, current, saturate, integrate_and_fire};

} // namespace
} // namespace shearwake::neural

template <>
const shearwake::neural::NeuronKernels&
shearwake::simd::compiled<shearwake::neural::NeuronKernels, shearwake::simd::this_set>() {
    return neural::table;
}
