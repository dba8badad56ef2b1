// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"

#include <algorithm>

namespace shearwake::spectral {

void Stepper::each_reaction(const Reaction& use) {
    Block* force = pencil_.data();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        bodies_->begin_forces(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block) {
            const std::ptrdiff_t at = row * vectors_.blocks() + block;
            std::fill(pencil_.begin(), pencil_.end(), Block{});
            bodies_->add_force(row, block, force);
            operator_.solve_implicit(factor(at), force);
            slab_bodies_.hold(row, block, background_solve(), force);
            if (use) use(row, block, at, force);
            clock_.lap(Phase::solves, pencil_bytes(2.0));
            put_strain(row, block, force);
        }
        planes_->end_row(row,
                         is_nyquist ? StrainPlanes::Modes::emptied : StrainPlanes::Modes::kept);
    }
}

void Stepper::constrain_step() {
    if (bodies_->empty()) return;
    const double scale = first_step_scale();
    bodies_->advance(scale);
    clock_.lap(Phase::rest);
    double work = 0.0;
    each_reaction([&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil,
                      const Block* displacement) {
        Block pressure[parts];
        load_.put(row, block, pressure);
        work += add_to_next(row, block, pencil, scale, displacement, pressure);
    });
    watch_.add_work(scale * work);
    if (!field_.variation().empty()) add_planes(change_);
}

void Stepper::add_planes(LateralField::Values& values) {
    planes_->get(reaction_);
    for (std::size_t i = 0; i < values.size(); ++i)
        values[i] += reaction_[i];
}

} // namespace shearwake::spectral
