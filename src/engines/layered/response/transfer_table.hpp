// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/case_progress.hpp"
#include "engines/layered/response/loss_tables.hpp"
#include "engines/layered/response/point_response.hpp"
#include "engines/layered/response/radial_interpolant.hpp"
#include "engines/layered/response/stack_response.hpp"
#include "fft/aligned.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Largest distance of two points of a grid with open edges for which its tables hold.
double open_reach_m(std::ptrdiff_t nx, std::ptrdiff_t ny, double spacing_m);

/// What the transfer tables of all media share on one grid with open edges. Not collective.
struct OpenGrid {
    std::ptrdiff_t nx, ny;
    double spacing_m;
    PointResponse point = {spacing_m, open_reach_m(nx, ny, spacing_m)};
    LossResponse loss = {spacing_m, open_reach_m(nx, ny, spacing_m)};
    PlaneSampling sampling = {nx / 2, ny / 2};

    OpenGrid(std::ptrdiff_t nx_points, std::ptrdiff_t ny_points, double spacing)
        : nx(nx_points), ny(ny_points), spacing_m(spacing) {}
    bool is_of(std::ptrdiff_t nx_points, std::ptrdiff_t ny_points, double spacing) const {
        return nx == nx_points && ny == ny_points && spacing_m == spacing;
    }
};

/// Time transform of a run: `samples` steps of `step_s` form one period of the discrete transform.
/// Evaluating at omega - i decay makes it aperiodic: the load is multiplied by e^{-decay t} and the
/// result by e^{+decay t}. In the periodic regime decay is 0, and the first sample is at the first
/// frame.
struct TimeTransform {
    std::ptrdiff_t samples = 0;
    double step_s = 0.0;
    double decay_rad_s = 0.0;
    double first_s = 0.0;
    bool operator==(const TimeTransform&) const = default;

    /// omega_m - i decay [rad/s] for m = 0 ... samples/2.
    std::complex<double> omega(std::ptrdiff_t m) const;
    /// The last time at which the load matters.
    double end_s(const TimeAxis& time) const { return time.duration_s() + first_s; }
    double sample_s(std::ptrdiff_t i) const { return first_s + static_cast<double>(i) * step_s; }
};

/// Everything that H depends on. Cases with equal keys share one table.
struct TransferKey {
    Medium medium;
    std::vector<double> depths_m;
    std::ptrdiff_t nx = 0, ny = 0;
    double spacing_m = 0.0;
    TimeTransform time;
    double tolerance = 0.0;
    StackQuantity quantity = StackQuantity::displacement;
    DomainEdges edges = DomainEdges::periodic;
    bool operator==(const TransferKey&) const = default;
};

/// H(|k|, omega; z) [m/Pa], or the compression [1], or the loss [m/(Pa s)] of one medium: Chebyshev
/// panels in |k| for every frequency and, if memory permits, their values on the points (ky, kx >=
/// 0) of this rank.
///
/// With open edges the values are those for which the periodic convolution on the grid of the key
/// equals the convolution on the infinite plane, for loads and points less than half of the grid
/// apart: the transform of the low-pass filtered response to a point load, plus the remainder of H
/// (point_response.hpp). They are always in memory.
class TransferTable {
public:
    /// Distributes the frequencies over the team and exchanges the panels. This rank needs rows
    /// ky_start to ky_start + ky_count - 1 of the spectrum. Throws CaseFailure on all ranks if H
    /// cannot be resolved, and StopRequested if a stop was requested. Collective.
    /// `grid`: kept by the caller for further tables on this grid with open edges; null if the
    /// edges are periodic.
    TransferTable(const TransferKey& key, std::ptrdiff_t ky_start, std::ptrdiff_t ky_count,
                  const Comm& team, OpenGrid* grid = nullptr, CaseProgress* progress = nullptr);

    const TransferKey& key() const { return key_; }
    std::ptrdiff_t frequencies() const { return key_.time.samples / 2 + 1; }
    std::ptrdiff_t half_nx() const { return key_.nx / 2 + 1; }

    /// H for local row `ky` at one depth: values [kx >= 0][frequency]. Valid until the next call.
    /// Not collective.
    std::span<const std::complex<double>> row(std::ptrdiff_t ky, std::size_t depth);

    std::size_t panels() const; // sum over all frequencies
    /// Memory in bytes of the values of all rows and depths on a rank with ky_count rows.
    static double expanded_bytes(const TransferKey& key, std::ptrdiff_t ky_count);
    /// Above this size the rows are evaluated again for each case.
    static constexpr double largest_expansion_B = 250e6;

private:
    /// The panels of the frequencies of this rank, and the size of each.
    struct Panels {
        std::vector<std::complex<double>> values;
        std::vector<double> sizes;
    };
    template <class F>
    bool each_frequency(const Comm& team, CaseProgress* progress, const F& f) const;
    Panels fit(const Comm& team, CaseProgress* progress) const;
    /// The tables of the response to a point load of the frequencies of this rank.
    std::vector<std::complex<double>> point_tables(OpenGrid& grid, const Comm& team,
                                                   CaseProgress* progress) const;
    void expand_open(const OpenGrid& grid, std::span<const std::complex<double>> tables,
                     const Comm& team, CaseProgress* progress);
    void add_remainder(std::ptrdiff_t ky, std::size_t depth, std::complex<double>* row) const;
    std::vector<double> wavenumbers_rad_m(std::ptrdiff_t ky) const;
    /// The panels begin at this wavenumber.
    double first_rad_m() const;
    void expand(std::ptrdiff_t ky, std::size_t depth, std::complex<double>* out) const;

    TransferKey key_;
    std::ptrdiff_t ky_start_, ky_count_;
    std::vector<RadialInterpolant> by_frequency_;
    bool expanded_ = false;
    fft::AlignedVector<std::complex<double>> values_; // all rows and depths, or one row
};

} // namespace shearwake::layered
