// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "parallel/comm.hpp"

#include <cstddef>

namespace shearwake::spectral {

/// Checks that the energy of a field does not exceed the work of the load. With v+ = u+ - u the
/// scheme preserves
///     E = 1/2 v+.(A - C/(2 dt)) v+ + 1/2 u.K u+,   with the implicit operator A:
/// each step adds the work f.(u+ - u-)/2 and removes the losses by viscosity and drag. E itself
/// does not reveal an instability, in which it is the difference of two growing quantities.
/// However,
///     E >= 1/2 v.(A - K/4) v >= 0.02 (1/2 v.M v/dt^2)
/// where the scheme is stable (vertical_operator.hpp). Therefore the kinetic energy of a stable
/// field never exceeds fifty times the work, and is usually smaller than the work.
class EnergyWatch {
public:
    /// Checks every `interval`-th step.
    EnergyWatch(const Comm& team, double step_s, std::ptrdiff_t interval)
        : team_(team), step_s_(step_s), interval_(interval) {}

    /// Checks the field before step `step` if it is due. `kinetic_J_m2` is this rank's part of the
    /// kinetic energy per area; the work of the step has not been added yet. Throws FieldDiverges
    /// on all ranks together. Collective.
    void look(std::ptrdiff_t step, double kinetic_J_m2);
    /// Checks the field at any step. Throws FieldDiverges on all ranks together. Collective.
    void judge(std::ptrdiff_t step, double kinetic_J_m2);

    /// Adds this rank's part of the work per area of a step. Not collective.
    void add_work(double work_J_m2) { work_J_m2_ += work_J_m2; }
    /// Total work per area of all ranks. Collective.
    double work_J_m2() const { return team_.sum(work_J_m2_); }
    /// Sets the total work so far [J/m^2]. Not collective.
    void restore(double work_J_m2);

private:
    Comm team_;
    double step_s_;
    std::ptrdiff_t interval_;
    double work_J_m2_ = 0.0; // this rank's part
    double most_J_m2_ = 0.0; // maximum work of all ranks at the checked steps
};

} // namespace shearwake::spectral
