// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <numeric>

namespace shearwake::spectral {

// With v+ = u+ - u and the implicit operator A the scheme preserves
//     E = 1/2 v+.(A - C/(2 dt)) v+ + 1/2 u.K u+.
// Each step adds the work f.(u+ - u-)/2 and removes the losses by viscosity and drag.
EnergyBalance Stepper::energy() {
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    const double rate = 1.0 / step_s_;
    fft::AlignedVector<Block> memory;
    LateralField::Values rest;
    together(team_, [&] {
        memory.assign(static_cast<std::size_t>(3 * size), Block{});
        rest.assign(field_.size(), 0.0);
    });
    Block *change = memory.data(), *force = change + size, *zero = force + size;
    double kinetic = 0.0, implicit = 0.0, stored = 0.0, viscous = 0.0;
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) continue;
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const std::ptrdiff_t at = row * vectors_.blocks() + block;
            const Block *now = now_.data() + at * size, *before = before_.data() + at * size;
            const Block k = vectors_.waves(row, block).k;
            const Counted counted = vectors_.counted(row, block);
            const auto inner = [&](const Block* a, const Block* b) {
                return sum_of(kernels_.product(size, a, b, counted.part));
            };
            kernels_.difference(size, 1.0, now, before, change);
            kinetic += 0.5 * sum_of(operator_.twice_kinetic(rate, now, before, counted.part));
            std::fill_n(force, size, Block{});
            operator_.add_internal_force(k, 0.0, before, before, force);
            stored -= inner(force, now); // -K u-
            std::fill_n(force, size, Block{});
            operator_.add_internal_force(k, rate, zero, change, force);
            viscous += inner(force, change); // C v/dt
            implicit += sum_of(operator_.implicit_form(factor(at), change, counted.part));
        }
    }
    double lateral = 0.0;
    if (!field_.variation().empty()) {
        const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
        // Work arrays of a step are free between two steps.
        LateralField::Values& difference = change_;
        for (std::size_t i = 0; i < strain_.size(); ++i)
            difference[i] = strain_[i] - strain_before_[i];
        const auto inner = [](const LateralField::Values& a, const LateralField::Values& b) {
            return std::inner_product(a.begin(), a.end(), b.begin(), 0.0);
        };
        if (field_.variation().iterates) {
            for (std::size_t point = 0; point < field_.points(); ++point)
                field_.implicit(point, difference, stress_);
            lateral += 0.5 * inner(difference, stress_);
        }
        field_.stress(strain_before_, strain_before_, 0.0, stress_); // K u-
        lateral += 0.5 * inner(strain_, stress_);
        field_.stress(rest, difference, rate, stress_); // -C v/dt
        lateral += 0.25 * inner(difference, stress_);
        lateral *= per_point;
    }
    watch_.check(step_, kinetic);
    const double bodies = team_.is_root() ? bodies_->twice_kinetic_J_m2() : 0.0;
    const double mine = 0.5 * (implicit - 0.5 * viscous + stored + bodies) + lateral;
    const double area_m2 = case_.domain.extent_x_m() * case_.domain.extent_y_m();
    return {area_m2 * team_.sum(mine), area_m2 * watch_.work_J_m2()};
}

} // namespace shearwake::spectral
