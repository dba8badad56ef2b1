// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/energy_balance.hpp"

#include <cmath>
#include <fmt/format.h>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;
/// The tables of H and of the loss are accurate to about 1e-8 of the energy.
constexpr double allowed_imbalance = 1e-6;

} // namespace

EnergySums::EnergySums(const TimeTransform& time, std::span<const double> roll_off)
    : samples_(time.samples) {
    for (std::ptrdiff_t m = 0; 2 * m < samples_; ++m) {
        const double roll = roll_off[static_cast<std::size_t>(m)];
        omega_rad_s_.push_back(time.omega(m).real());
        share_.push_back(roll * roll);
    }
}

void EnergySums::add(std::span<const Complex> load, std::span<const Complex> h,
                     std::span<const Complex> loss, double weight) {
    double work = 0.0, layers = 0.0, half_space = 0.0;
    for (std::size_t m = 1; m < omega_rad_s_.size(); ++m) {
        const Complex up = load[m], down = load[static_cast<std::size_t>(samples_) - m];
        const double square = share_[m] * (up.real() * up.real() + up.imag() * up.imag() +
                                           down.real() * down.real() + down.imag() * down.imag());
        work -= square * omega_rad_s_[m] * h[m].imag();
        layers += square * loss[m].real();
        half_space += square * loss[m].imag();
    }
    work_ += weight * work;
    layers_ += weight * layers;
    half_space_ += weight * half_space;
}

engines::PeriodEnergy EnergySums::total(double scale, const Comm& team) const {
    return {.work_J = scale * team.sum(work_),
            .absorbed_in_layers_J = scale * team.sum(layers_),
            .radiated_J = scale * team.sum(half_space_)};
}

engines::SolverReport report_of(const engines::PeriodEnergy& energy) {
    engines::SolverReport report;
    report.period_energy = energy;
    if (!(std::abs(energy.imbalance()) <= allowed_imbalance))
        report.warnings.push_back(
            {Severity::warning, "time.regime",
             fmt::format("the energy balance of the steady state is not met: the work of the load "
                         "and the energy that the medium absorbs differ by {:.1e} of the work, "
                         "more than {:.0e}; reduce domain.spacing_mm, or enlarge "
                         "domain.extent_mm if the load leaves the domain",
                         energy.imbalance(), allowed_imbalance)});
    return report;
}

} // namespace shearwake::layered
