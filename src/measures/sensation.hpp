// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"
#include "base/view.hpp"
#include "measures/surface_sums.hpp"
#include "problem/case/case.hpp"

#include <complex>
#include <span>
#include <string>
#include <vector>

namespace shearwake::measures {

struct Column;

// The level of sensation at a point of the surface: the normal acceleration above the threshold of
// perception, L = max over third octaves of 10 log10(sum of (a_k / a_0(f_k))^2), where a_k is the
// rms of a spectral line in the band and a_0 the threshold at its frequency. Nothing in it is
// fitted to the studies that it is compared with.

/// A third octave, with exact edges 10^((n -+ 1/2)/10) Hz. The built-in table begins at 8 Hz and
/// ends at 500 Hz, in the middle of its first and last band.
struct SensationBand {
    double centre_Hz = 0.0; // nominal
    double low_Hz = 0.0, high_Hz = 0.0;
    double threshold_m_s2 = 0.0; // rms
    bool is_extrapolated = false;
};

/// The bands of a table of centres [Hz] and thresholds [m/s^2 rms]. Empty: 17 values from 8 to
/// 315 Hz for a handle that the whole hand grips, adapted to third octaves by the notebook
/// HDActuatorTest of the Haptics Industry Forum (HDActuatorSpec) from Morioka and Griffin 2006,
/// Journal of Sound and Vibration 295, 633-648, continued to 500 Hz with the slope between its
/// points at 160 and 315 Hz. A gripped handle has a threshold that is 10 to 18 dB lower than that
/// of a small probe, and a level has no spatial summation.
std::vector<SensationBand> sensation_bands(std::span<const Vec2> table = {});

/// Difference of amplitude that is just noticeable [dB], and the range of its values (Israr, Tan
/// and Reed 2006, JASA 120).
constexpr double jnd_dB = 2.3, least_jnd_dB = 1.65, largest_jnd_dB = 2.98;

/// The spectral lines from which levels are computed: multiples of 1/period of a load that repeats.
/// In the periodic regime they are those of the run, otherwise of the largest whole number of
/// periods between `measure.settled_after` and `measure.at`, in which the lines of a settled motion
/// are exact.
struct SensationLines {
    std::vector<SensationBand> bands;
    std::vector<double> frequencies_Hz;
    double window_s = 0.0; // duration of the window
    std::string reason;    // why no level is computed; empty: one is
    /// The factors of u in frame `number` in the complex amplitudes of the acceleration [1/s^2].
    /// The acceleration is the second difference in time, which a constant and a drift do not
    /// change, divided by its response at the frequency of the line.
    std::vector<std::complex<double>> factors(std::ptrdiff_t number) const;
    /// The threshold at a frequency: a straight line between the centres of the bands over log f
    /// and log a, constant before the first and after the last centre.
    double threshold_m_s2(double f_Hz) const;
    /// Index of the band that contains a frequency; the number of bands if none does.
    std::size_t band_of(double f_Hz) const;

    std::vector<double> weights; // of the frames in the second difference, with sum 1
    double interval_s = 0.0;
    bool repeats = false; // the frame after the last one is the first one
};
SensationLines sensation_lines(const Case& c);

/// Levels on the rectangle of samples that contains the measured region, row-major. NaN where
/// nothing moves in any band.
struct SensationMap {
    std::ptrdiff_t x0 = 0, y0 = 0, rows = 0, columns = 0; // of the rectangle, in global indices
    std::vector<double> level_dB;
    std::vector<double> band_Hz; // nominal centre of the band that decides
    std::vector<double> sum_dB;  // 10 log10 of the sum over all lines of (a_k / a_0)^2
};

/// Sums of the frames of the rows of a slab inside the rectangle of the measured region. Not
/// collective.
class SensationSums {
public:
    /// Without lines or outside the rectangle, nothing is allocated.
    SensationSums(const Case& c, std::ptrdiff_t x_start, std::ptrdiff_t x_count);

    /// The frame of this number, in any order, each once.
    void add(std::ptrdiff_t number, View2<const double> u_z_m);
    /// The sums so far, one row after the other. Complete after flush().
    double* sums() { return scalars(sums_.data()); }
    void flush();
    /// Sums per row, whose columns are filled up to complete blocks.
    std::ptrdiff_t row_length() const;
    /// The rows of this slab, which follow those of the slab before.
    SensationMap levels();

    const SensationLines& lines() const { return lines_; }
    std::ptrdiff_t first_row() const { return first_; } // relative to the rectangle
    std::ptrdiff_t row_count() const { return count_; }
    std::ptrdiff_t all_rows() const { return region_.x1 - region_.x0; }

private:
    SensationLines lines_;
    Region region_;
    std::ptrdiff_t x_start_ = 0, first_ = 0, count_ = 0, columns_ = 0;
    std::ptrdiff_t filled_ = 0;   // columns in complete blocks
    std::ptrdiff_t waiting_ = 0;  // frames in `frames_`
    std::vector<Block> frames_;   // frames that are added together
    std::vector<double> factors_; // real and imaginary, of each line and waiting frame
    std::vector<Block> sums_;
};

/// Memory of the sums and maps of one of `ranks` ranks [B]; 0 if nothing is computed.
double sensation_memory_B(const Case& c, int ranks);

/// The `felt_` columns of a case. `map` is the complete rectangle. Not collective.
std::vector<Column> sensation_columns(const Case& c, const SensationMap& map);

} // namespace shearwake::measures
