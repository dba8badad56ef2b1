// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spectrum.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <complex>

namespace shearwake::measures {
namespace {

constexpr double highest_drawn_Hz = 2000.0;
constexpr double coarsest_step_Hz = 10.0;

/// sum_n u_n e^{-i 2 pi f t_n}, t_n = (n + 1) dt.
std::complex<double> transform(std::span<const double> trace, double dt_s, double frequency_Hz) {
    // The phasor is advanced by multiplication: its error grows by 1e-16 per step, so it is
    // recomputed at the start of each block.
    constexpr std::size_t block = 64;
    const std::complex<double> turn = std::polar(1.0, -two_pi * frequency_Hz * dt_s);
    std::complex<double> sum, phasor;
    for (std::size_t n = 0; n < trace.size(); ++n) {
        if (n % block == 0)
            phasor = std::polar(1.0, -two_pi * frequency_Hz * dt_s * static_cast<double>(n + 1));
        sum += trace[n] * phasor;
        phasor *= turn;
    }
    return sum;
}

} // namespace

std::vector<double> amplitude_spectrum(std::span<const double> trace, double dt_s,
                                       std::span<const double> frequencies_Hz) {
    const double nyquist_Hz = 0.5 / dt_s, samples = static_cast<double>(trace.size());
    std::vector<double> amplitudes;
    amplitudes.reserve(frequencies_Hz.size());
    for (const double f : frequencies_Hz) {
        const double sides = f == 0.0 ? 1.0 : 2.0;
        amplitudes.push_back(f <= nyquist_Hz * (1.0 + 1e-12)
                                 ? sides / samples * std::abs(transform(trace, dt_s, f))
                                 : not_a_number);
    }
    return amplitudes;
}

std::vector<double> spectrum_frequencies_Hz(double duration_s) {
    const double limit = std::min(coarsest_step_Hz, 0.25 / duration_s) * (1.0 + 1e-12);
    const double decade = std::pow(10.0, std::floor(std::log10(limit)));
    double step = decade;
    for (const double digit : {2.0, 5.0, 10.0})
        if (digit * decade <= limit) step = digit * decade;
    std::vector<double> frequencies;
    for (int i = 0; step * i <= highest_drawn_Hz * (1.0 + 1e-12); ++i)
        frequencies.push_back(step * i);
    return frequencies;
}

std::vector<double> trace_frequencies_Hz(const TimeAxis& time) {
    if (time.regime == Regime::transient) return spectrum_frequencies_Hz(time.duration_s());
    const double lines = std::min(highest_drawn_Hz * time.duration_s() * (1.0 + 1e-12),
                                  0.5 * static_cast<double>(time.frames));
    std::vector<double> frequencies;
    for (int n = 0; n <= lines; ++n)
        frequencies.push_back(n / time.duration_s());
    return frequencies;
}

double strongest_line_Hz(std::span<const double> frequencies_Hz,
                         std::span<const double> amplitudes) {
    assert(frequencies_Hz.size() == amplitudes.size());
    double largest = 0.0, at_Hz = not_a_number;
    for (std::size_t i = 1; i < frequencies_Hz.size(); ++i)
        if (amplitudes[i] > largest) {
            largest = amplitudes[i];
            at_Hz = frequencies_Hz[i];
        }
    return at_Hz;
}

double line_rms(std::span<const double> trace, double dt_s, double low_Hz, double high_Hz) {
    const auto samples = static_cast<double>(trace.size());
    const double period_s = dt_s * samples;
    double mean_square = 0.0;
    for (double n = std::ceil(low_Hz * period_s - 1e-9);
         n <= std::min(high_Hz * period_s + 1e-9, 0.5 * samples); ++n) {
        const double amplitude = std::abs(transform(trace, dt_s, n / period_s)) / samples;
        const bool is_single = n == 0.0 || 2.0 * n == samples; // others occur at -f also
        mean_square += (is_single ? 1.0 : 2.0) * amplitude * amplitude;
    }
    return std::sqrt(mean_square);
}

double peak_frequency_Hz(std::span<const double> frequencies_Hz, std::span<const double> amplitudes,
                         double lowest_Hz) {
    assert(frequencies_Hz.size() == amplitudes.size());
    std::size_t peak = frequencies_Hz.size();
    double largest = 0.0;
    for (std::size_t i = 0; i < frequencies_Hz.size(); ++i)
        if (frequencies_Hz[i] >= lowest_Hz && amplitudes[i] > largest) {
            largest = amplitudes[i];
            peak = i;
        }
    if (peak == 0 || peak + 1 >= frequencies_Hz.size()) return not_a_number;
    const double below = amplitudes[peak - 1], above = amplitudes[peak + 1];
    if (!(largest >= below && largest >= above)) return not_a_number;

    // Vertex of the parabola through three points at distances l and r, in Newton's form.
    const double l = frequencies_Hz[peak] - frequencies_Hz[peak - 1];
    const double r = frequencies_Hz[peak + 1] - frequencies_Hz[peak];
    const double left = (largest - below) / l, right = (above - largest) / r;
    const double curvature = (right - left) / (l + r); // half the second derivative
    if (!(curvature < 0.0)) return frequencies_Hz[peak];
    const double slope = (left * r + right * l) / (l + r);
    return frequencies_Hz[peak] - 0.5 * slope / curvature;
}

double band_rms(std::span<const double> trace, double dt_s, double low_Hz, double high_Hz) {
    // |U|^2 = dt^2 sum_lag r_lag cos(2 pi f lag dt), lags of both signs, r the autocorrelation.
    const std::size_t samples = trace.size();
    if (samples == 0) return not_a_number;
    double integral = 0.0;
    for (std::size_t lag = 0; lag < samples; ++lag) {
        double r = 0.0;
        for (std::size_t n = lag; n < samples; ++n)
            r += trace[n] * trace[n - lag];
        const double omega = two_pi * static_cast<double>(lag) * dt_s;
        integral += lag == 0
                        ? r * (high_Hz - low_Hz)
                        : 2.0 * r * (std::sin(omega * high_Hz) - std::sin(omega * low_Hz)) / omega;
    }
    const double mean_square = 2.0 * dt_s / static_cast<double>(samples) * integral;
    return std::sqrt(std::max(0.0, mean_square)); // rounding may give -1e-17 for an empty band
}

double rms_between(const TimeAxis& time, std::span<const double> trace, const FrequencyBand& band) {
    return time.regime == Regime::periodic
               ? line_rms(trace, time.interval_s, band.low_Hz, band.high_Hz)
               : band_rms(trace, time.interval_s, band.low_Hz, band.high_Hz);
}

std::vector<double> differences(const TimeAxis& time, std::span<const double> trace) {
    std::vector<double> steps;
    double last = time.regime == Regime::periodic && !trace.empty() ? trace.back() : 0.0;
    for (const double value : trace) {
        steps.push_back(value - last);
        last = value;
    }
    return steps;
}

ShareBands share_bands(const TimeAxis& time, const FrequencyBand& band) {
    const double lowest_Hz = 1.0 / time.duration_s(), low_Hz = std::max(band.low_Hz, lowest_Hz);
    return {.part = {low_Hz, std::max(low_Hz, band.high_Hz)},
            .total = {lowest_Hz, 0.5 / time.interval_s}};
}

} // namespace shearwake::measures
