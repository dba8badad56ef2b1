#pragma once

#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "neural/lines.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Samples at the neurons' rate of a line of `samples` at `rate_Hz`: round(N 5000 / rate), halves
/// to even.
std::size_t resampled_length(std::size_t samples, double rate_Hz);

/// Whether the rate is the neurons' own, to 1e-9 of itself.
bool is_neuron_rate(double rate_Hz);

/// From `from` samples to `to` over the same time by their Fourier series: everything above half
/// the lower rate vanishes, and the line is taken as periodic, so that a jump between its ends
/// rings at both of them. At half the lower rate the two ends of the spectrum are one. Not
/// collective.
class FourierResampler {
public:
    FourierResampler(std::size_t from, std::size_t to);

    void operator()(std::span<const double> line, std::span<double> resampled);
    /// Two lines at the price of one.
    void operator()(std::span<const double> line_a, std::span<const double> line_b,
                    std::span<double> resampled_a, std::span<double> resampled_b);

private:
    void resample(); // of what stands in from_, into to_

    AlignedVector<std::complex<double>> from_, to_;
    LineTransform forward_, backward_;
};

/// Every line at the neurons' rate; as they are if they have it. Not collective.
Lines at_neuron_rate(const Lines& lines, double rate_Hz);

} // namespace shearwake::neural
