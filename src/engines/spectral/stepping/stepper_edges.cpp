// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"

namespace shearwake::spectral {

/// Half of the loss of u - u- is subtracted from u and half is added to u-, so that their mean does
/// not change. Of the energy of the scheme,
///     v.(A - C/(2 dt) - K/4) v/2 + m.K m/2,   v = u - u-, m = (u + u-)/2,
/// the second term stays constant, and the first one decreases as the velocity does. The energy was
/// never observed to rise at any step. If the loss were applied to only one of u and u-, the
/// fastest modes would grow. Where steps iterate, the response to the impulse is that of the layers
/// without the body: the removed velocity is the same, and the following steps correct the strain
/// of a stiff body.
void Stepper::damp(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at, Block* change) {
    sponge_.impulse(operator_, row, block, change);
    operator_.solve_implicit(factor(at), change);
    slab_bodies_.hold(row, block, background_solve(), change);
    add_impulse(at, change);
}

void Stepper::begin_damping() {
    sponge_.take_velocity(operator_, vectors_.blocks(), now_, before_);
    if (is_uniform()) return;
    Block* change = pencil_.data();
    bodies_->clear();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        sponge_.begin_row(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block) {
            damp(row, block, row * vectors_.blocks() + block, change);
            put_strain(row, block, change);
            if (!bodies_->empty()) bodies_->evaluate(row, block, change);
        }
        planes_->end_row(row,
                         is_nyquist ? StrainPlanes::Modes::emptied : StrainPlanes::Modes::kept);
        bodies_->end_row(row);
    }
    predicted_.valid = false;
    planes_->get(change_);
    constrain_damping();
    for (std::size_t i = 0; i < change_.size(); ++i) {
        strain_[i] += change_[i];
        strain_before_[i] -= change_[i];
    }
}

/// The impulse on rigid bodies is that of the velocity removed from the material in their place;
/// the mass in excess of it follows.
void Stepper::constrain_damping() {
    if (bodies_->empty()) return;
    bodies_->respond();
    bodies_->add_impulse();
    each_reaction([&](std::ptrdiff_t, std::ptrdiff_t, std::ptrdiff_t at, const Block* change) {
        add_impulse(at, change);
    });
    add_planes(change_);
}

void Stepper::add_impulse(std::ptrdiff_t at, const Block* change) {
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    kernels_.add_scaled(size, 1.0, change, now_.data() + at * size);
    kernels_.add_scaled(size, -1.0, change, before_.data() + at * size);
}

} // namespace shearwake::spectral
