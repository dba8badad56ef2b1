#pragma once

#include "engines/layered/transfer_table.hpp"
#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "model/case.hpp"
#include "model/load_pattern.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake {

/// How the load of a case is sampled in time: sample spacing and period of the transform.
/// The step divides the output interval; it resolves 1.25 times the band of footprint, scan,
/// envelope and carrier together (where the footprint's spectrum has fallen to 1e-6).
TimeTransform time_transform(const Case& c, const LayeredOptions& options);

/// Output intervals per sample of the transform.
std::ptrdiff_t samples_per_frame(const Case& c, const TimeTransform& time);

/// Weights of the time samples that integrate a load against a smooth response:
/// Gregory's 3/8, 7/6, 23/24 at the step at t = 0 (error of fourth order in the step; a plain half
/// would leave second order, a full sample first order), the covered part of the hat functions at a
/// path's end, and, after the last frame, where nothing can matter any more, a cos^2 taper over
/// half of what is left of the period, so that the transform sees no edge.
std::vector<double> sample_weights(const Case& c, const TimeTransform& time);

/// Low-pass over the frequencies of the transform, in FFT order: 1 up to 0.8 of the highest, which
/// is the load's whole band, then cos^2 to 0. A step at t = 0 has more than the samples can carry;
/// cut off sharply it would ring for ever (as dt^3 / t), and e^{decay t} would raise that a
/// thousandfold: 0.5 % of the field at 50 us. So the step is this smooth, within three samples.
std::vector<double> roll_off(const TimeTransform& time);

/// Time transforms of w_n e^{-decay t_n} e(t_n) c(t_n) e^{-i k . (x_f(t_n) - corner)}, the load at
/// wave vector k over its peak, seen from the grid's corner, times the roll-off: without the
/// pattern on the skin where that is always the same, with it where it changes. For ky_count rows
/// of wave vectors from ky_start on. Not collective.
class LoadSpectrum {
public:
    LoadSpectrum(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_start,
                 std::ptrdiff_t ky_count);

    /// All `samples` frequencies in FFT order. Valid until the next call.
    std::span<const std::complex<double>> line(std::ptrdiff_t kx, std::ptrdiff_t ky);

    /// What a line is to be multiplied with [m^2]: the spectrum of a pattern that is always the
    /// same. Zero: the line need not be asked for.
    std::complex<double> factor(std::ptrdiff_t kx, std::ptrdiff_t ky) const;

    /// Bytes that the changing pattern of a case takes, 0 if it does not change.
    static double memory_B(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_count);

private:
    std::vector<Vec2> origins_of_samples(const Case& c, const TimeTransform& time);
    double kx_rad_m(std::ptrdiff_t kx) const;

    std::ptrdiff_t nx_, ny_, samples_, ky_start_, ky_count_;
    double dkx_rad_m_, dky_rad_m_;
    LoadPattern pattern_;
    LineTransform forward_;
    std::vector<double> roll_off_;
    bool y_rests_ = false;
    std::vector<std::complex<double>> weighted_;   // per sample
    AlignedVector<std::complex<double>> x_phases_; // (kx, sample): transformed if y rests
    std::vector<std::complex<double>> y_phases_;   // (ky, sample), or (ky) if y rests
    AlignedVector<std::complex<double>> buffer_;
    // A changing pattern: which of its states each sample has; spectra (ky, kx, state) of this
    // rank's rows and of |kx| and ky up to these modes, beyond which there is nothing.
    std::vector<std::size_t> state_of_;
    std::size_t states_ = 0;
    std::ptrdiff_t last_kx_ = 0, rows_there_ = 0;
    AlignedVector<std::complex<double>> changing_;
};

} // namespace shearwake
