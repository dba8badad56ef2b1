// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/energy_watch.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::spectral {
namespace {

constexpr double most_of_work = 50.0; // 1 / 0.02
constexpr const char* advice =
    "a shorter solver.spectral.time_step_us, a smaller contrast_cap or a smaller residual may help";

} // namespace

void EnergyWatch::look(std::ptrdiff_t step, double kinetic_J_m2) {
    if (step % interval_ == 0) judge(step, kinetic_J_m2);
}

void EnergyWatch::judge(std::ptrdiff_t step, double kinetic_J_m2) {
    double sums[2] = {kinetic_J_m2, work_J_m2_};
    team_.sum(std::span<double>(sums));
    const double kinetic = sums[0], t_ms = 1e3 * static_cast<double>(step) * step_s_;
    // Checked first, because comparisons with NaN are false.
    if (!std::isfinite(kinetic) || !std::isfinite(sums[1]))
        throw FieldDiverges(
            fmt::format("step {} at {:.4g} ms: the field is not finite; {}", step, t_ms, advice));
    most_J_m2_ = std::max(most_J_m2_, sums[1]);
    if (kinetic > most_of_work * most_J_m2_)
        throw FieldDiverges(fmt::format(
            "step {} at {:.4g} ms: the field diverges: its kinetic energy is {:.3g} J/m2, but the "
            "total work of the load is only {:.3g} J/m2; {}",
            step, t_ms, kinetic, most_J_m2_, advice));
}

void EnergyWatch::restore(double work_J_m2) {
    work_J_m2_ = team_.is_root() ? work_J_m2 : 0.0;
    most_J_m2_ = work_J_m2;
}

} // namespace shearwake::spectral
