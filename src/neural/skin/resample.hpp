// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "neural/skin/lines.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Number of samples at the neurons' rate for a line of N `samples` at `rate_Hz`: round(N 5000 /
/// rate), ties to even.
std::size_t resampled_length(std::size_t samples, double rate_Hz);

/// Whether the rate is the neurons' own within a relative tolerance of 1e-9.
bool is_neuron_rate(double rate_Hz);

/// Fourier resampling from `from` to `to` samples over the same duration. Content above half of the
/// lower rate is removed. The line is treated as periodic, so that a jump between its ends causes
/// ringing at both of them. At half of the lower rate the two ends of the spectrum coincide. Not
/// collective.
class FourierResampler {
public:
    FourierResampler(std::size_t from, std::size_t to);

    void operator()(std::span<const double> line, std::span<double> resampled);
    /// Resamples two lines at the cost of one.
    void operator()(std::span<const double> line_a, std::span<const double> line_b,
                    std::span<double> resampled_a, std::span<double> resampled_b);

private:
    void resample(); // from from_ into to_

    fft::AlignedVector<std::complex<double>> from_, to_;
    fft::LineTransform forward_, backward_;
};

/// Resamples every line to the neurons' rate, or copies the lines if they already have it. Not
/// collective.
Lines at_neuron_rate(const Lines& lines, double rate_Hz);

} // namespace shearwake::neural
