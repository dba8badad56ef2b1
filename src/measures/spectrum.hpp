// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <span>
#include <vector>

namespace shearwake::measures {

// Spectra of a trace u_n = u(t_n), t_n = (n + 1) dt, n = 0 .. N-1, zero at t = 0, of duration
// T = N dt. The transform is the sum U(f) = dt sum_n u_n e^{-i 2 pi f t_n}: it is exact for tones
// of whole periods, and Parseval's theorem holds for it to rounding.

/// One-sided amplitude 2/T |U(f)|, at f = 0 1/T |U|, in the unit of u: a tone of amplitude a shows
/// as a. NaN above the Nyquist frequency 1/(2 dt), where the trace contains no information.
std::vector<double> amplitude_spectrum(std::span<const double> trace, double dt_s,
                                       std::span<const double> frequencies_Hz);

/// 0 to 2000 Hz in steps of 1, 2 or 5 times a power of ten, at most a quarter of 1/T and at most 10
/// Hz, which is fine enough for a curve.
std::vector<double> spectrum_frequencies_Hz(double duration_s);

/// The frequencies at which the spectrum of a trace is stored: those above or, in the periodic
/// regime, the lines of the period up to 2000 Hz.
std::vector<double> trace_frequencies_Hz(const TimeAxis& time);

// A trace of exactly one period has a line spectrum, at multiples of 1/T.

/// The frequency of the strongest line above 0 Hz; NaN if there is none.
double strongest_line_Hz(std::span<const double> frequencies_Hz,
                         std::span<const double> amplitudes);
/// Root mean square of the lines between two frequencies, ends included.
double line_rms(std::span<const double> trace, double dt_s, double low_Hz, double high_Hz);

/// The frequency of the largest amplitude at or above lowest_Hz, refined by the parabola through it
/// and its neighbours. NaN if the amplitude is zero, or largest at the edge of the range, so that
/// the range contains no peak. Callers pass 1/T, below which the spectrum contains only drift.
double peak_frequency_Hz(std::span<const double> frequencies_Hz, std::span<const double> amplitudes,
                         double lowest_Hz);

/// Root mean square over the run of the part of u between two frequencies,
///     sqrt( 2/T integral_low^high |U(f)|^2 df ),
/// integrated in closed form: |U|^2 is the cosine series of the trace's autocorrelation. From 0 to
/// 1/(2 dt) it is the rms of the samples. The cost grows with N^2: 0.1 ms for N = 280.
double band_rms(std::span<const double> trace, double dt_s, double low_Hz, double high_Hz);

/// line_rms in the periodic regime and band_rms otherwise. Its square is a quadratic form of the
/// trace.
double rms_between(const TimeAxis& time, std::span<const double> trace, const FrequencyBand& band);

/// du/dt multiplied by the time between frames; before the first frame is 0 or, in the periodic
/// regime, the last one.
std::vector<double> differences(const TimeAxis& time, std::span<const double> trace);

/// The frequencies of a share: the energy between those of `part` divided by that between those of
/// `whole`, which begins at 1/T.
struct ShareBands {
    FrequencyBand part, total;
};
ShareBands share_bands(const TimeAxis& time, const FrequencyBand& band);

} // namespace shearwake::measures
