// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "neural/hand/hand.hpp"
#include "neural/skin/skin.hpp"
#include "problem/case/afferents.hpp"
#include "problem/case/plan.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Whether traces have a beginning and an end, or are one period of a motion that repeats for ever.
enum class Course { once, periodic };

/// Errors and warnings about pins and their traces: radius, overlap, non-finite values, sampling,
/// mixed signs, jumps at the ends without silence, pins outside of the skin (`skin_mm` is its
/// outline; empty: unbounded). Not collective.
std::vector<Remark> check_stimulus(const PinStimulus& stimulus, double silence_s,
                                   const Polygon& skin_mm, Course course = Course::once);

/// Errors and warnings about the traces of stress [Pa] at receptors, one line per afferent. Not
/// collective.
std::vector<Remark> check_stress(std::span<const std::vector<double>> compression_Pa,
                                 double rate_Hz, std::size_t afferents, double silence_s,
                                 Course course = Course::once);

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

/// A stimulus of `duration_s` in which all pins move identically. Throws UsageError if the sampling
/// rate is too low for the carrier. Not collective.
PinStimulus carrier_stimulus(const CarrierInput& carrier, std::vector<Vec2> pins_mm,
                             double radius_mm, double duration_s);

/// Lines with silence before and after.
struct SilencedLines {
    Lines lines;
    double before_s = 0.0; // duration of the silence that precedes the lines
};

/// Adds `silence_s` of skin at rest before the lines; afterwards the last indentations decrease
/// as cos^2 over the same time. Without silence a jump between the ends would cause ringing at both
/// ends, because resampling to the neurons' rate treats them as periodic. The end is
/// extended so that the total duration is an integer number of samples of the neurons. The lines
/// are returned unchanged if `silence_s` is 0. Not collective.
SilencedLines with_silence(const Lines& lines, double rate_Hz, double silence_s);

} // namespace shearwake::neural
