#pragma once

#include "parallel/comm.hpp"

#include <cstddef>

namespace shearwake {

/// Whether a field stays within what the load has put in. With v+ = u+ - u the scheme keeps
///     E = 1/2 v+.(A - C/(2 dt)) v+ + 1/2 u.K u+,   A the implicit operator:
/// each step adds the work f.(u+ - u-)/2 to it and takes away what viscosity and drag consume. E
/// itself tells nothing of an instability, where it is the difference of two that grow. But
///     E >= 1/2 v.(A - K/4) v >= 0.02 (1/2 v.M v/dt^2)
/// where the scheme is stable (vertical_operator.hpp): so the kinetic energy is never above fifty
/// times the work, and most often below it.
class EnergyWatch {
public:
    /// Looks at every `interval`-th step.
    EnergyWatch(const Comm& team, double step_s, std::ptrdiff_t interval)
        : team_(team), step_s_(step_s), interval_(interval) {}

    /// This rank's parts per area [J/m^2]: of the kinetic energy before step `step`, whose work is
    /// not yet added. Collective; throws FieldDiverges on all ranks together.
    void look(std::ptrdiff_t step, double kinetic_J_m2);
    /// The same at any step.
    void judge(std::ptrdiff_t step, double kinetic_J_m2);

    void add_work(double work_J_m2) { work_J_m2_ += work_J_m2; }
    /// Of all ranks. Collective.
    double work_J_m2() const { return team_.sum(work_J_m2_); }
    /// From now on the work so far is that [J/m^2]. Not collective.
    void restore(double work_J_m2);

private:
    Comm team_;
    double step_s_;
    std::ptrdiff_t interval_;
    double work_J_m2_ = 0.0; // this rank's part
    double most_J_m2_ = 0.0; // of the work of all ranks, as far as looked at
};

} // namespace shearwake
