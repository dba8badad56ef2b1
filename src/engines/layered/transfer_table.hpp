#pragma once

#include "engines/layered/radial_interpolant.hpp"
#include "engines/layered/stack_response.hpp"
#include "fft/aligned.hpp"
#include "model/case.hpp"
#include "parallel/comm.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake {

/// The time transform of a run: `samples` steps of `step_s` make one period of the discrete
/// transform, omega -> omega - i decay makes it aperiodic: the load is multiplied by e^{-decay t},
/// the result by e^{+decay t}.
struct TimeTransform {
    std::ptrdiff_t samples = 0;
    double step_s = 0.0;
    double decay_rad_s = 0.0;
    bool operator==(const TimeTransform&) const = default;

    /// omega_m - i decay for m = 0 ... samples/2.
    std::complex<double> omega(std::ptrdiff_t m) const;
};

/// What H depends on: cases that agree in this share one table.
struct TransferKey {
    Medium medium;
    std::vector<double> depths_m;
    std::ptrdiff_t nx = 0, ny = 0;
    double spacing_m = 0.0;
    TimeTransform time;
    double tolerance = 0.0;
    StackQuantity quantity = StackQuantity::displacement;
    bool operator==(const TransferKey&) const = default;
};

/// H(|k|, omega; z) [m/Pa], or the compression [1], of one medium, as Chebyshev panels in |k| for
/// every frequency, and, where memory allows, expanded on the (ky, kx >= 0) points of this rank.
class TransferTable {
public:
    /// Collective over the team: the frequencies are shared out, the panels exchanged.
    /// Rows ky_start ... ky_start + ky_count - 1 of the spectrum are this rank's.
    TransferTable(const TransferKey& key, std::ptrdiff_t ky_start, std::ptrdiff_t ky_count,
                  const Comm& team);

    const TransferKey& key() const { return key_; }
    std::ptrdiff_t frequencies() const { return key_.time.samples / 2 + 1; }
    std::ptrdiff_t half_nx() const { return key_.nx / 2 + 1; }

    /// H for local row `ky`, one depth: values [kx >= 0][frequency]. Valid until the next call.
    /// Not collective.
    std::span<const std::complex<double>> row(std::ptrdiff_t ky, std::size_t depth);

    std::size_t panels() const; // over all frequencies
    /// Bytes that the expanded table of a rank takes.
    static double expanded_bytes(const TransferKey& key, std::ptrdiff_t ky_count);
    /// Above this the rows are expanded anew for each case.
    static constexpr double largest_expansion_B = 250e6;

private:
    void expand(std::ptrdiff_t ky, std::size_t depth, std::complex<double>* out) const;

    TransferKey key_;
    std::ptrdiff_t ky_start_, ky_count_;
    std::vector<RadialInterpolant> by_frequency_;
    bool expanded_ = false;
    AlignedVector<std::complex<double>> values_; // all rows and depths, or one row
};

} // namespace shearwake
