// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/layered/response/transfer_table.hpp"
#include "parallel/comm.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Sums, over the wave vectors and frequencies of a periodic load, of the work of the load and of
/// the energy that the medium absorbs, see docs/explanation/engine-layered.md.
class EnergySums {
public:
    /// `roll_off` per frequency of the transform.
    EnergySums(const TimeTransform& time, std::span<const double> roll_off);

    /// Adds a wave vector: its load at all frequencies, and H at the surface and the loss at the
    /// frequencies from 0. Not collective.
    void add(std::span<const std::complex<double>> load, std::span<const std::complex<double>> h,
             std::span<const std::complex<double>> loss, double weight);

    /// Joules per period of all ranks; `scale`: period times area. Collective.
    engines::PeriodEnergy total(double scale, const Comm& team) const;

private:
    std::ptrdiff_t samples_;
    std::vector<double> omega_rad_s_, share_; // by frequency; share: square of the roll-off
    double work_ = 0.0, layers_ = 0.0, half_space_ = 0.0;
};

/// The energies, and a warning if the balance is not met. Not collective.
engines::SolverReport report_of(const engines::PeriodEnergy& energy);

} // namespace shearwake::layered
