// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/layered/load/jump_tail.hpp"
#include "problem/case/case.hpp"
#include "problem/load/load.hpp"

#include <Eigen/Core>
#include <array>
#include <span>

namespace shearwake::layered {

/// Estimated error of the field after jumps and kinks of the load, relative to the maximum of the
/// field, at the measured depth where it is largest. It is computed at the focus for a few
/// wavenumbers of the footprint, from the difference between H and the sum of powers of TailFit
/// above the highest frequency of the transform. No member function is collective.
class BreakError {
public:
    /// The breaks of breaks_of() for cells of `cell_s`.
    BreakError(const Case& c, std::span<const Break> breaks, double cell_s);
    /// The error for samples `step_s` apart; 0 for a load without breaks.
    double relative(double step_s) const;

private:
    static constexpr int wavenumbers = 12;
    static constexpr std::size_t orders = 3; // jump, kink, bend
    /// By depth: the sum over all wave vectors of the footprint.
    Eigen::VectorXcd at_focus(std::complex<double> omega_rad_s) const;
    void choose_wavenumbers();

    const Case& case_;
    double cell_s_;
    std::array<double, orders> sizes_{}; // of the largest jump, kink and bend, over a cell
    Eigen::VectorXd typical_m_Pa_;       // magnitude of the field, by depth
    std::array<double, wavenumbers> k_rad_m_{}, weight_{};
    double sigma_m_ = 0.0;
};

/// The spectrum of a footprint falls to this fraction at the end of its band.
inline constexpr double band_fraction = 1e-6;

} // namespace shearwake::layered
