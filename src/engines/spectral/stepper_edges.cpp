#include "engines/spectral/stepper.hpp"

namespace shearwake {

/// Half of the loss of u - u- is taken from u and half is given to u-, so that what they have in
/// common stays: of the scheme's energy,
///     v.(A - C/(2 dt) - K/4) v/2 + m.K m/2,   v = u - u-, m = (u + u-)/2,
/// the second part does, and the first one falls as the velocity does: energy was never seen to
/// rise, at any step. Taken from one of them alone, the loss makes the fastest modes grow. Where
/// steps iterate, the answer is the layers' and not the body's: the velocity that is taken is the
/// same, what it strains a stiff body by is left to the steps that follow.
void Stepper::damp(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at, Lanes* change) {
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    sponge_.impulse(operator_, row, block, change);
    operator_.solve_implicit(factor(at), change);
    Lanes *u = lanes(now_.data()) + at * size, *before = lanes(before_.data()) + at * size;
    for (std::ptrdiff_t i = 0; i < size; ++i) {
        u[i] += change[i];
        before[i] -= change[i];
    }
}

void Stepper::begin_damping() {
    sponge_.take_velocity(operator_, vectors_.blocks(), now_, before_);
    if (field_.variation().empty()) return;
    Lanes* change = lanes(pencil_.data());
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        sponge_.begin_row(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block) {
            damp(row, block, row * vectors_.blocks() + block, change);
            put_strain(row, block, change);
        }
        planes_->end_row(row, is_nyquist);
    }
    planes_->get(change_);
    for (std::size_t i = 0; i < change_.size(); ++i) {
        strain_[i] += change_[i];
        strain_before_[i] -= change_[i];
    }
}

} // namespace shearwake
