// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/kernels/response.hpp"
#include "engines/layered/load/time_nodes.hpp"
#include "engines/layered/response/case_progress.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "fft/aligned.hpp"
#include "fft/line_transform.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load_pattern.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Spectra of a steered pattern at the positions of its focus, kept for cases with the same array,
/// path, grid and times.
struct SteeredSpectra {
    /// Everything that they depend on.
    struct Key {
        Footprint footprint;
        Trajectory trajectory;
        std::vector<Vec2> foci_m;
        std::vector<double> times_s; // of which each has a state
        double end_s = 0.0, dkx_rad_m = 0.0, dky_rad_m = 0.0;
        std::ptrdiff_t nx = 0, ny = 0, ky_start = 0, ky_count = 0;
        bool operator==(const Key&) const = default;
    };
    Key key;
    std::vector<std::size_t> state_of; // of each time
    std::vector<Vec2> origins_m;       // of each state
    /// (ky, kx, state) of this rank's rows, limited to the modes |kx| and ky below which the
    /// pattern has content.
    std::ptrdiff_t last_kx = 0, rows = 0;
    fft::AlignedVector<std::complex<double>> values;
};

/// Transforms in time of e^{-decay t} e(t) c(t) e^{-i k . (x_f(t) - corner)}, divided by the step:
/// the load at wave vector k divided by its peak, relative to the corner of the grid, without the
/// roll-off. The integrals are those of TimeNodes, exact for jumps and kinks. The pattern on the
/// skin is included if it changes in time; otherwise factors() provides it. Covers ky_count rows of
/// wave vectors from ky_start.
class LoadSpectrum {
public:
    /// Uses or replaces the `steered` spectra of an earlier case, and frees them if the pattern is
    /// constant. Throws StopRequested if a stop was requested. Collective.
    LoadSpectrum(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_start,
                 std::ptrdiff_t ky_count, SteeredSpectra& steered, CaseProgress& progress);

    struct Line {
        /// All `samples` frequencies in FFT order.
        std::span<const std::complex<double>> load;
        /// The jumps of the load and of its first three derivatives at each break [steps^-b].
        std::span<const std::complex<double>> jumps;
    };
    /// For global kx and local ky. Valid until the next call.
    Line line(std::ptrdiff_t kx, std::ptrdiff_t ky);
    const TimeNodes& nodes() const { return nodes_; }

    /// Factors [m^2] by which the lines of one ky must be multiplied, for all kx: the spectrum of a
    /// constant pattern and, if the focus moves along x alone, the phase in y. The line of a zero
    /// factor is not needed.
    void factors(std::ptrdiff_t ky, std::span<std::complex<double>> out) const;

    /// Whether the focus moves along x alone. Then the line at -kx is the conjugate of that at kx
    /// at negative frequencies, and the response over time at -kx is the conjugate of that at kx.
    bool is_mirrored() const { return y_rests_; }

    /// Whether the focus of a case moves along x alone, see is_mirrored().
    static bool moves_along_x(const Case& c, const TimeTransform& time);

    /// Memory in bytes of the changing pattern of a case on a rank with ky_count rows; 0 if the
    /// pattern is constant.
    static double memory_B(const Case& c, const TimeTransform& time, std::ptrdiff_t ky_count);

private:
    std::vector<Vec2> origins_of_times(const Case& c, double end_s, CaseProgress& progress);
    void compute_steered(SteeredSpectra::Key key, CaseProgress& progress);
    void transform(std::complex<double>* values, std::complex<double>* jumps_of_line) const;

    const ResponseKernels& kernels_;
    std::ptrdiff_t nx_, ny_, samples_, ky_start_, ky_count_;
    double dkx_rad_m_, dky_rad_m_;
    std::vector<double> kx_rad_m_; // of all kx
    TimeNodes nodes_;
    LoadPattern pattern_;
    fft::LineTransform forward_;
    bool y_rests_;
    std::vector<std::complex<double>> weighted_; // per time of nodes_
    /// (kx, time of nodes_); transformed to (kx, frequency) if y_rests_.
    fft::AlignedVector<std::complex<double>> x_phases_;
    std::vector<std::complex<double>> y_phases_; // (ky, time of nodes_), or (ky) if y_rests_
    fft::AlignedVector<std::complex<double>> buffer_;
    std::vector<std::complex<double>> jumps_; // of a line, or (kx, jump) if y_rests_
    SteeredSpectra& steered_;
};

} // namespace shearwake::layered
