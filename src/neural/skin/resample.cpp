// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/resample.hpp"

#include "neural/fibre/afferent.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::neural {

std::size_t resampled_length(std::size_t samples, double rate_Hz) {
    return static_cast<std::size_t>(
        std::nearbyint(static_cast<double>(samples) / rate_Hz * neuron_rate_Hz));
}

bool is_neuron_rate(double rate_Hz) {
    return std::abs(rate_Hz - neuron_rate_Hz) <= 1e-9 * neuron_rate_Hz;
}

Lines at_neuron_rate(const Lines& lines, double rate_Hz) {
    if (is_neuron_rate(rate_Hz)) return lines;
    Lines out(lines.count, resampled_length(lines.samples, rate_Hz));
    FourierResampler resample(lines.samples, out.samples);
    std::size_t i = 0;
    for (; i + 1 < lines.count; i += 2)
        resample(lines.line(i), lines.line(i + 1), out.line(i), out.line(i + 1));
    if (i < lines.count) resample(lines.line(i), out.line(i));
    return out;
}

FourierResampler::FourierResampler(std::size_t from, std::size_t to)
    : from_(from), to_(to), forward_(static_cast<std::ptrdiff_t>(from), fft::Direction::forward),
      backward_(static_cast<std::ptrdiff_t>(to), fft::Direction::backward) {}

void FourierResampler::operator()(std::span<const double> line, std::span<double> resampled) {
    std::copy(line.begin(), line.end(), from_.begin());
    resample();
    for (std::size_t k = 0; k < to_.size(); ++k)
        resampled[k] = to_[k].real();
}

void FourierResampler::operator()(std::span<const double> line_a, std::span<const double> line_b,
                                  std::span<double> resampled_a, std::span<double> resampled_b) {
    // The operation maps real lines to real lines, so that a second line in the imaginary part
    // stays separate.
    for (std::size_t k = 0; k < from_.size(); ++k)
        from_[k] = {line_a[k], line_b[k]};
    resample();
    for (std::size_t k = 0; k < to_.size(); ++k) {
        resampled_a[k] = to_[k].real();
        resampled_b[k] = to_[k].imag();
    }
}

void FourierResampler::resample() {
    const std::size_t N = from_.size(), M = to_.size(), shorter = std::min(N, M);
    forward_.execute(from_.data());
    std::fill(to_.begin(), to_.end(), 0.0);
    to_[0] = from_[0];
    for (std::size_t f = 1; 2 * f < shorter; ++f) {
        to_[f] = from_[f];
        to_[M - f] = from_[N - f];
    }
    if (shorter % 2 == 0) { // the shorter spectrum has a single value for both +f and -f
        const std::size_t f = shorter / 2;
        if (M < N) {
            to_[f] = from_[f] + from_[N - f];
        } else if (M > N) {
            to_[f] = 0.5 * from_[f];
            to_[M - f] = 0.5 * from_[f];
        } else {
            to_[f] = from_[f];
        }
    }
    backward_.execute(to_.data());
    const double scale = 1.0 / static_cast<double>(N);
    for (std::complex<double>& value : to_)
        value *= scale;
}

} // namespace shearwake::neural
