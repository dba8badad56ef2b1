// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

namespace shearwake::neural {

/// A time series that reaches a receptor with a delay and a gain.
struct DelayedLine {
    const double* values;
    std::ptrdiff_t delay; // samples
    double gain;
};

/// y[k] = b (x[k] + 3 x[k-1] + 3 x[k-2] + x[k-3]) - a1 y[k-1] - a2 y[k-2] - a3 y[k-3]
struct LowPass {
    Block b, a1, a2, a3;
};

/// Weights of the positive and negative parts of a current, see neural/fibre/fibre.hpp.
struct CurrentWeights {
    Block static_positive, static_negative, rate_positive, rate_negative, jerk_positive,
        jerk_negative;
};

/// Kernels of the functions of neural/fibre/fibre.hpp. A block is one sample of eight afferents.
struct NeuronKernels {
    /// sum[k] = sum over the lines of gain * values[k - delay], 0 before the delay; `samples`
    /// values each.
    void (*sum_delayed)(const DelayedLine* lines, std::ptrdiff_t count, std::ptrdiff_t samples,
                        double* sum);
    void (*low_pass)(const LowPass& filter, std::ptrdiff_t samples, Block* line);
    /// Overwrites the dynamic term d with the current; s may be null.
    void (*current)(const CurrentWeights& weights, std::ptrdiff_t samples, const Block* s,
                    Block* d);
    void (*saturate)(const Block& saturation, std::ptrdiff_t samples, Block* current);
    /// Bit i of fired[k] is set if afferent i fires in sample k. after_spike[j] is the current j
    /// samples after a spike; its last entry, with index `longest`, is 0 and applies to all later
    /// samples.
    void (*integrate_and_fire)(const Block& membrane_samples, const Block* after_spike,
                               std::ptrdiff_t longest, std::ptrdiff_t samples, const Block* current,
                               unsigned char* fired);
};

/// Minimum number of samples between two spikes.
constexpr std::ptrdiff_t shortest_interval = 6;

} // namespace shearwake::neural
