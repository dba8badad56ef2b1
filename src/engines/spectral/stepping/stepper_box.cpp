// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"
#include "parallel/agree.hpp"

#include <algorithm>

namespace shearwake::spectral {

void Stepper::assemble_box() {
    // With rigid bodies the response depends on the positions of both cells.
    if (!solver_ || !bodies_->empty() || !slab_bodies_.empty()) return;
    const std::optional<BoxGrid> grid =
        box_grid(case_.domain, field_.cells().extent(&team_),
                 {.planes = static_cast<double>(planes_->count()),
                  .factor_entries = static_cast<double>(operator_.factor_size()),
                  .steps = case_.time.duration_s() / step_s_});
    if (!grid) return;
    box_.emplace(field_, *grid, slabs_, team_, clock_);
    box_->assemble(
        [&](std::ptrdiff_t plane, StrainPlanes& planes) { respond_to_plane(plane, planes); });
    together(team_, [&] {
        predicted_.change.resize(now_.size());
        predicted_.load.resize(static_cast<std::size_t>(vectors_.pencils() * parts));
        predicted_.strain.resize(field_.size());
    });
}

void Stepper::respond_to_plane(std::ptrdiff_t plane, StrainPlanes& planes) {
    const std::ptrdiff_t components = transfer_.components(), pitch = 2 * slabs_.nx();
    const StrainPoint& point = transfer_.points()[static_cast<std::size_t>(plane / components)];
    const StrainTransfer one(mesh_, {point}, static_cast<int>(components));
    std::vector<double> unit(static_cast<std::size_t>(components * pitch), 0.0);
    for (std::ptrdiff_t i = 0; i < slabs_.nx(); ++i)
        unit[static_cast<std::size_t>(plane % components * pitch + 2 * i)] = 1.0;
    const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
    Block* force = pencil_.data();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) {
            planes.end_row(row, StrainPlanes::Modes::emptied);
            continue;
        }
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            std::fill(pencil_.begin(), pencil_.end(), Block{});
            const WaveBlock waves = vectors_.waves(row, block);
            one.add_force(waves, unit.data(), pitch, per_point, force);
            operator_.solve_implicit(factor(row * vectors_.blocks() + block), force);
            transfer_.strain(planes.in_line(waves), force, planes.line(row), planes.stride());
        }
        planes.end_row_from(row, plane);
    }
}

// With G = E B^-1 E^T, g = B^-1 (f - K u - C (u - u-)/dt) and the explicit stress s of the bodies,
//     e = E g - G t,   t = s + S e,   d = g - B^-1 E^T t.
// The box yields G, so that t is known before B is solved for it.
void Stepper::advance_on_box() {
    if (!predicted_.valid) predict_all();
    if (watch_.due(step_)) watch_.check(step_, 0.5 * kinetic_.mine());
    watch_.add_work(first_step_scale() * work_.mine());
    reference_ = std::max(kinetic_.of(team_), std::abs(work_.of(team_)));
    clock_.lap(Phase::rest);
    field_.stress(strain_, strain_before_, 1.0 / step_s_, stress_);
    // Reading or writing an array counts 1, the moduli 1/2.
    clock_.lap(Phase::products, value_bytes(4.5));
    box_->respond(stress_, change_, BoxResponse::Precision::full);
    for (std::size_t i = 0; i < change_.size(); ++i)
        change_[i] += predicted_.strain[i];
    if (iterate() > 0) {
        const LateralField::Values& implicit = solver_->stress();
        for (std::size_t i = 0; i < stress_.size(); ++i)
            stress_[i] += implicit[i];
    }
    clock_.lap(Phase::products, value_bytes(6.0));
    planes_->set(stress_);
    complete_and_predict();
    advance_strains();
}

StrainSolver::Responses Stepper::on_box() {
    const auto with = [this](BoxResponse::Precision precision) {
        return [this, precision](const LateralField::Values& stress, LateralField::Values& strain) {
            box_->respond(stress, strain, precision);
        };
    };
    return {.full = with(BoxResponse::Precision::full),
            .rounded = with(BoxResponse::Precision::rounded)};
}

void Stepper::predict_all() {
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    kinetic_.clear();
    work_.clear();
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const bool is_nyquist = vectors_.is_nyquist(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !is_nyquist; ++block) {
            const std::ptrdiff_t at = row * vectors_.blocks() + block;
            predict(row, block, first_step_scale(), now_.data() + at * size,
                    before_.data() + at * size, factor(at));
        }
        planes_->end_row(row,
                         is_nyquist ? StrainPlanes::Modes::emptied : StrainPlanes::Modes::kept);
    }
    planes_->get(predicted_.strain);
    predicted_.valid = true;
}

void Stepper::predict(std::ptrdiff_t row, std::ptrdiff_t block, double scale, const Block* u,
                      const Block* before, const Block* needed) {
    const std::ptrdiff_t at = row * vectors_.blocks() + block;
    Block* change = predicted_.change.data() + at * operator_.unknowns() * parts;
    Block* pressure = predicted_.load.data() + at * parts;
    put_forces(row, block, u, before, change, pressure, needed);
    operator_.solve_implicit(factor(at), change);
    add_work(row, block, scale, u, before, change, pressure);
    clock_.lap(Phase::solves, pencil_bytes(3.0));
    put_strain(row, block, change);
}

void Stepper::complete_and_predict() {
    const double scale = first_step_scale();
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    Block* response = pencil_.data();
    double work = 0.0;
    kinetic_.clear();
    work_.clear();
    predicted_.valid = !sponge_.acts_at(step_ + 1); // which changes the displacement
    if (predicted_.valid) load_.sample(step_ + 1);
    const Strains strains = predicted_.valid ? Strains::needed : Strains::unused;
    each_pencil(strains, [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at) {
        const Block *u = now_.data() + at * size, *change = predicted_.change.data() + at * size;
        Block* before = before_.data() + at * size;
        std::fill_n(response, size, Block{});
        add_planes_force(row, block, response);
        operator_.solve_implicit(factor(at), response);
        kernels_.advance_by_sum(size, scale, u, change, response, before);
        work += work_of_change(row, block, scale, response, predicted_.load.data() + at * parts);
        clock_.lap(Phase::solves, pencil_bytes(2.0));
        if (!predicted_.valid) return;
        // The factor of the next pencil, since this one is in the cache.
        predict(row, block, 1.0, before, u, factor(std::min(at + 1, vectors_.pencils() - 1)));
    });
    watch_.add_work(scale * work);
    if (predicted_.valid) planes_->get(predicted_.strain);
}

} // namespace shearwake::spectral
