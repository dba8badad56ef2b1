// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/kernels/response.hpp"
#include "engines/layered/load/time_nodes.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "fft/aligned.hpp"

#include <Eigen/Core>
#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// gamma_q(s) = 1/pi Re integral_0^inf (1 - roll_off(x / pi)) (i x)^{-q} e^{i x s} dx, for q = 1
/// ... 9: what the roll-off removes from a signal that is s^{q-1} / (q-1)! for s > 0 and 0 before.
/// It decays within a few units of s. Tabulated for |s| <= tail_reach and 0 beyond. Not collective.
double removed_part(int q, double s);
inline constexpr double tail_reach = 14.0; // steps; gamma is below 1e-3 of its maximum there

/// H at high frequencies as a sum of powers, H = sum_a c_a (i x)^{-a} with real c_a, where x is the
/// frequency in rad per step: a = 1 ... 5, and for stresses, which follow a jump of the load at
/// once, a = 0 as well. Fitted by least squares to the last 40 % of the frequencies of a transform.
class TailFit {
public:
    TailFit(std::ptrdiff_t samples, StackQuantity quantity);
    /// Indices of the frequencies at which H is fitted.
    const std::vector<std::ptrdiff_t>& frequencies() const { return frequencies_; }
    int lowest_power() const { return lowest_; }
    /// The coefficients follow from the real and imaginary parts of H at these frequencies, in
    /// turns, by multiplication with this matrix: one row per power.
    const Eigen::MatrixXd& matrix() const { return matrix_; }

private:
    std::vector<std::ptrdiff_t> frequencies_;
    int lowest_;
    Eigen::MatrixXd matrix_;
};

/// The response to jumps of the load and of its first three derivatives, above the highest
/// frequency of the transform: the jump D_b of the b-th derivative adds sum_a c_a D_b
/// gamma_{a+b+1}((t - t_jump) / step) to the response at t, with the coefficients of TailFit. Not
/// collective.
class JumpTail {
public:
    /// Of a case whose frames are `per_frame` samples apart.
    JumpTail(const TimeNodes& nodes, const TimeTransform& time, std::ptrdiff_t per_frame,
             StackQuantity quantity);

    /// Adds the responses to all breaks to a line of frames. `h`: H at the frequencies from 0;
    /// `jumps`: jump_orders per break.
    void add(const ResponseKernels& kernels, std::span<const std::complex<double>> h,
             const std::complex<double>* jumps, std::complex<double>* line) const;

private:
    /// Successive frames near a break.
    struct Near {
        std::size_t of_break;
        std::ptrdiff_t first, count; // in a line of frames
        std::size_t at;              // of the first weight
    };
    void add_near(const TailFit& fit, std::size_t of_break, std::ptrdiff_t first,
                  std::span<const double> distances, double samples);

    std::vector<std::ptrdiff_t> frequencies_;
    std::vector<Near> near_;
    fft::AlignedVector<double> weights_; // of each Near: [b][re and im of H in turns][frame]
};

} // namespace shearwake::layered
