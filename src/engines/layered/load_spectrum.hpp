// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "engines/layered/kernels/response.hpp"
#include "engines/layered/transfer_table.hpp"
#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "load/load_pattern.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Sample spacing and period of the time transform of a case. The step divides the output interval
/// and resolves 1.25 times the combined bandwidth of footprint, scan, envelope and carrier (up to
/// where the spectrum of the footprint has fallen to 1e-6). Not collective.
TimeTransform time_transform(const Case& c, const LayeredOptions& options);

/// Number of output intervals per sample of the transform.
std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time);

/// Weights of the time samples that integrate the load against a smooth response. At the step at t
/// = 0 these are Gregory's weights 3/8, 7/6, 23/24 (error of fourth order in the step; weights of
/// 1/2 and 1 would give second and first order). At the end of a path a weight is the covered part
/// of the hat function. After the last frame, where the load no longer matters, a cos^2 taper over
/// half of the rest of the period avoids an edge.
std::vector<double> sample_weights(const Case& c, const TimeTransform& time);

/// Low-pass filter over the frequencies of the transform, in FFT order: 1 up to 0.8 of the highest
/// frequency, which covers the bandwidth of the load, then cos^2 to 0. A step at t = 0 exceeds this
/// bandwidth. With a sharp cutoff it would ring with an amplitude of dt^3 / t, which e^{decay t}
/// amplifies a thousandfold: 0.5 % of the field at 50 us. With the filter the step is smooth within
/// three samples.
std::vector<double> roll_off(const TimeTransform& time);

/// Time transforms of w_n e^{-decay t_n} e(t_n) c(t_n) e^{-i k . (x_f(t_n) - corner)}: the load at
/// wave vector k divided by its peak, relative to the corner of the grid, without the roll-off. The
/// pattern on the skin is included if it changes in time; otherwise factors() provides it. Covers
/// ky_count rows of wave vectors from ky_start. Not collective.
class LoadSpectrum {
public:
    LoadSpectrum(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_start,
                 std::ptrdiff_t ky_count);

    /// All `samples` frequencies in FFT order for global kx and local ky. Valid until the next
    /// call.
    std::span<const std::complex<double>> line(std::ptrdiff_t kx, std::ptrdiff_t ky);

    /// Factors [m^2] by which the lines of one ky must be multiplied, for all kx: the spectrum of a
    /// constant pattern and, if the focus moves along x alone, the phase in y. The line of a zero
    /// factor is not needed.
    void factors(std::ptrdiff_t ky, std::span<std::complex<double>> out) const;

    /// Whether the focus moves along x alone. Then the line at -kx is the conjugate of that at kx
    /// at negative frequencies, and the response over time at -kx is the conjugate of that at kx.
    bool is_mirrored() const { return y_rests_; }

    /// Whether the focus of a case moves along x alone, see is_mirrored().
    static bool keeps_y(const Case& c, const TimeTransform& time);

    /// Memory in bytes of the changing pattern of a case on a rank with ky_count rows; 0 if the
    /// pattern is constant.
    static double memory_B(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_count);

private:
    std::vector<Vec2> origins_of_samples(const Case& c, const TimeTransform& time);

    const ResponseKernels& kernels_;
    std::ptrdiff_t nx_, ny_, samples_, ky_start_, ky_count_;
    double dkx_rad_m_, dky_rad_m_;
    std::vector<double> kx_rad_m_; // of all kx
    LoadPattern pattern_;
    fft::LineTransform forward_;
    bool y_rests_;
    std::vector<std::complex<double>> weighted_; // per sample
    /// (kx, sample); already transformed if y_rests_.
    fft::AlignedVector<std::complex<double>> x_phases_;
    std::vector<std::complex<double>> y_phases_; // (ky, sample), or (ky) if y_rests_
    fft::AlignedVector<std::complex<double>> buffer_;
    // For a changing pattern: the state at each sample, and the spectra (ky, kx, state) of this
    // rank's rows, limited to the modes |kx| and ky below which the pattern has content.
    std::vector<std::size_t> state_of_;
    std::size_t states_ = 0;
    std::ptrdiff_t last_kx_ = 0, rows_there_ = 0;
    fft::AlignedVector<std::complex<double>> changing_;
};

} // namespace shearwake::layered
