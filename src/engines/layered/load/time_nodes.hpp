// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/response/transfer_table.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"

#include <array>
#include <vector>

namespace shearwake::layered {

/// Low-pass filter over the frequencies of the transform, in FFT order: 1 up to 0.8 of the highest
/// frequency, which covers the bandwidth of the load, then cos^2 to 0. A step exceeds this
/// bandwidth; JumpTail adds its response above it.
std::vector<double> roll_off(const TimeTransform& time);
/// The same filter at a fraction of the highest frequency.
double roll_off(double of_highest);

/// The number of samples to which the contribution of a node is distributed, see TimeNodes.
inline constexpr std::ptrdiff_t taps = 24;
/// Half-width in steps of the window around a break in which the load has nodes of its own.
inline constexpr double break_window_steps = 10.0;
/// Coefficients c_l, l = -11 ... 12, for which sum_l c_l e^{i x l} approximates e^{i x share}, 0 <=
/// share < 1, at frequencies x [rad per sample] below 0.8 pi. They minimise the error weighted with
/// the roll-off and with 1/x^3, the spectrum of the response to a jump. Not collective.
std::array<double, taps> interpolation(double share);

/// The quadrature in time of a load: sum_i weight_i p(t_i) e^{-i omega t_i}, times the step, is the
/// integral of p e^{-i omega t} over one period, at all frequencies below the roll-off.
///
/// Where the load is smooth this is the sum over the samples of the transform. Towards a break
/// (problem/load/load.hpp) the weights of the samples fall smoothly to zero within ten samples,
/// and Gauss nodes on each side of the break integrate the rest. The contribution of a node is
/// distributed to samples by interpolation(), so that one discrete transform serves all. After the
/// last frame, where the load no longer matters, a cos^2 taper over half of the rest of the period
/// avoids an edge. Not collective.
class TimeNodes {
public:
    TimeNodes(const Case& c, const TimeTransform& time);

    /// All times [s] at which the load is needed: the samples of the transform, the nodes, and four
    /// times on each side of each break, with their weights [steps]. The last ones have weight 1.
    const std::vector<double>& times_s() const { return times_s_; }
    const std::vector<double>& weights() const { return weights_; }
    std::ptrdiff_t samples() const { return samples_; }
    std::ptrdiff_t nodes() const { return std::ssize(first_); }
    const std::vector<Break>& breaks() const { return breaks_; }

    /// The first sample to which each node contributes; the others follow it cyclically.
    const std::vector<std::ptrdiff_t>& first_samples() const { return first_; }
    /// taps values per node, each twice: for the real and the imaginary part.
    const std::vector<double>& coefficients() const { return coefficients_; }

private:
    double smooth_share(double t_s) const;
    void add_nodes(const Case& c, double from_s, double to_s);
    double taper(double t_s) const;
    double within_period_s(double t_s) const;

    TimeTransform time_;
    std::ptrdiff_t samples_;
    double duration_s_; // infinite in the periodic regime, where nothing is tapered
    std::vector<Break> breaks_;
    std::vector<double> times_s_, weights_, coefficients_;
    std::vector<std::ptrdiff_t> first_;
};

/// The load and its first three derivatives.
inline constexpr std::ptrdiff_t jump_orders = 4;
/// Their jumps at a break [steps^-b], from values at the last times of TimeNodes: `jump_orders`
/// before the break, nearest first, then as many after it.
std::array<std::complex<double>, jump_orders> jumps(const std::complex<double>* values);

} // namespace shearwake::layered
