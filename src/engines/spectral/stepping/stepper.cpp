// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/stepping/stepper.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/lump_bodies.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::spectral {

namespace {

/// E >= 1/2 v.(A - K/4) v >= 0.02 (1/2 v.M v/dt^2) where the scheme is stable
/// (vertical_operator.hpp).
constexpr double most_kinetic_1 = 50.0;
constexpr const char* watch_advice =
    "a shorter solver.spectral.time_step_us, a smaller contrast_cap or a smaller residual may help";

} // namespace

Stepper::Stepper(const Case& c, const DepthMesh& mesh, const fft::SlabTransform& slabs,
                 double step_s, const Comm& team)
    : case_(c), layers_(without_rigid_bodies(c)), mesh_(mesh), slabs_(slabs), team_(team),
      vectors_(c.domain, slabs.share()), step_s_(step_s),
      tolerance_(std::get<SpectralOptions>(c.solver).residual),
      field_(
          lateral_variation(layers_, mesh, slabs.share(), largest_k_rad_m(c.domain), step_s, &team),
          c.domain.ny, slabs.share()),
      operator_(mesh, field_.variation().background),
      transfer_(mesh, field_.variation().strain_points, field_.variation().components()),
      load_(c, vectors_, step_s),
      sponge_(c, vectors_, slabs,
              field_.variation().empty() && section_bodies(c).empty() && lump_bodies(c).empty()
                  ? Lateral::uniform
                  : Lateral::varies,
              step_s, team),
      bodies_(make_rigid_bodies(c, mesh, slabs, vectors_, step_s, team, clock_)),
      slab_bodies_(c, mesh, vectors_),
      // Checked at every step if steps iterate, because the failure of an iteration describes the
      // cause less well.
      watch_(team, step_s,
             {.most_1 = most_kinetic_1,
              .interval = field_.variation().iterates ? 1 : 16,
              .advice = watch_advice}),
      kinetic_(c.domain.ny / 2 + 1), work_(c.domain.ny / 2 + 1),
      kernels_(simd::kernels<PencilKernels>()), strain_kernels_(simd::kernels<StrainKernels>()) {
    planes_.emplace(field_.cells(), slabs_, team_, clock_, StrainPlanes::Corner{});
    together(team, [&] { assemble(); });
    // The energy of the scheme must be positive for all motion that the bodies permit; only light
    // ones reduce it. If so, the same holds for the implicit operator, which follows.
    if (std::find(mesh_.light.begin(), mesh_.light.end(), true) != mesh_.light.end())
        factorise(Operator::of_change);
    factorise(Operator::implicit);
    assemble_box();
}

RigidBodies::Solve Stepper::background_solve() const {
    return [this](std::ptrdiff_t row, std::ptrdiff_t block, Block* force) {
        operator_.solve_implicit(factor(row * vectors_.blocks() + block), force);
    };
}

RigidBodies::Solve Stepper::held_solve() {
    return [this](std::ptrdiff_t row, std::ptrdiff_t block, Block* force) {
        operator_.solve_implicit(factor(row * vectors_.blocks() + block), force);
        slab_bodies_.hold(row, block, background_solve(), force);
    };
}

void Stepper::assemble() {
    const std::ptrdiff_t pencils = vectors_.pencils(), factor_size = operator_.factor_size();
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    factors_.resize(static_cast<std::size_t>(pencils * factor_size));
    now_.assign(static_cast<std::size_t>(pencils * size), Block{});
    before_ = now_;
    sponge_.assemble(operator_.levels());
    pencil_.resize(static_cast<std::size_t>(size));
    planes_->assemble();
    for (auto* values : {&strain_, &strain_before_, &stress_, &change_})
        values->assign(field_.size(), 0.0);
    if (!bodies_->empty()) reaction_ = change_;
    if (field_.variation().iterates) solver_.emplace(field_, case_.domain.nx, team_, clock_);
}

void Stepper::factorise(Operator which) {
    together(team_, [&] {
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block)
                operator_.factorise(which, vectors_.waves(row, block).k, step_s_,
                                    factors_.data() + (row * vectors_.blocks() + block) *
                                                          operator_.factor_size());
        slab_bodies_.assemble(operator_, background_solve());
    });
    bodies_->assemble(operator_, held_solve());
}

void Stepper::advance() {
    const LateralVariation& variation = field_.variation();
    clock_.start();
    if (sponge_.acts_at(step_)) begin_damping();
    clock_.lap(Phase::sponge);
    load_.sample(step_);
    clock_.lap(Phase::rest);
    if (box_) {
        advance_on_box();
    } else if (variation.empty()) {
        first_pass();
        constrain_step();
    } else {
        field_.stress(strain_, strain_before_, 1.0 / step_s_, stress_);
        // Reading or writing an array counts 1, the moduli 1/2.
        clock_.lap(Phase::products, value_bytes(4.5));
        planes_->set(stress_);
        first_pass();
        planes_->get(change_);
        constrain_step();
        // d = B^-1 (rhs - E^T S e); its strain is e plus the remaining residual.
        if (variation.iterates && iterate() > 0) displace(solver_->stress());
        advance_strains();
    }
    statistics_.transforms = planes_->transforms();
    std::swap(now_, before_);
    bodies_->end_step();
    ++step_;
    ++statistics_.steps;
}

void Stepper::first_pass() {
    const double scale = first_step_scale();
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    Block* force = pencil_.data();
    kinetic_.clear();
    work_.clear();
    const bool damps = sponge_.acts_at(step_) && is_uniform();
    each_pencil(Strains::needed, [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at) {
        if (damps) {
            if (block == 0) sponge_.begin_row(row);
            if (sponge_.acts_on(row, block)) damp(row, block, at, force);
            clock_.lap(Phase::sponge);
        }
        const Block* u = now_.data() + at * size;
        Block* before = before_.data() + at * size;
        Block pressure[parts];
        put_forces(row, block, u, before, force, pressure, factor(at));
        clock_.lap(Phase::solves, pencil_bytes(3.0));
        add_planes_force(row, block, force);
        operator_.solve_implicit(factor(at), force);
        slab_bodies_.hold(row, block, background_solve(), force, scale, u, before);
        add_work(row, block, scale, u, before, force, pressure);
        clock_.lap(Phase::solves);
        put_strain(row, block, force);
        kernels_.advance(size, scale, u, force, before);
        if (!bodies_->empty()) bodies_->evaluate(row, block, before);
        clock_.lap(Phase::solves);
    });
    if (watch_.due(step_)) watch_.check(step_, 0.5 * kinetic_.mine());
    watch_.add_work(scale * work_.mine());
    if (solver_) reference_ = std::max(kinetic_.of(team_), std::abs(work_.of(team_)));
    clock_.lap(Phase::rest);
}

void Stepper::put_forces(std::ptrdiff_t row, std::ptrdiff_t block, const Block* u,
                         const Block* before, Block* force, Block* pressure, const Block* needed) {
    std::fill_n(force, operator_.unknowns() * parts, Block{});
    load_.put(row, block, pressure);
    std::copy_n(pressure, parts, force + parts); // unknown 1 is W at the surface
    operator_.add_internal_force(vectors_.waves(row, block).k, 1.0 / step_s_, u, before, force,
                                 needed);
    kinetic_.add(slabs_.share().ky_start + row,
                 sum_of(operator_.twice_kinetic(1.0 / step_s_, u, before,
                                                vectors_.counted(row, block).part)));
}

void Stepper::add_work(std::ptrdiff_t row, std::ptrdiff_t block, double scale, const Block* u,
                       const Block* before, const Block* change, const Block* pressure) {
    work_.add(slabs_.share().ky_start + row,
              work_of(vectors_.counted(row, block), pressure,
                      [&](std::ptrdiff_t p, std::ptrdiff_t lane) { // (u+ - u-)/2
                          return u[parts + p][lane] - before[parts + p][lane] +
                                 0.5 * scale * change[parts + p][lane];
                      }));
}

const Block* Stepper::factor(std::ptrdiff_t pencil) const {
    return factors_.data() + pencil * operator_.factor_size();
}

template <class Motion>
double Stepper::work_of(const Counted& counted, const Block* pressure, Motion motion) {
    Block work{};
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            work[lane] += counted.part[p][lane] * pressure[p][lane] * motion(p, lane);
    return sum_of(work);
}

void Stepper::add_planes_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* force) {
    const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
    transfer_.add_force(planes_->in_line(vectors_.waves(row, block)), planes_->line(row),
                        planes_->stride(), per_point, force);
    clock_.lap(Phase::transfer, block_bytes());
}

void Stepper::put_strain(std::ptrdiff_t row, std::ptrdiff_t block, const Block* displacement) {
    transfer_.strain(planes_->in_line(vectors_.waves(row, block)), displacement, planes_->line(row),
                     planes_->stride());
    clock_.lap(Phase::transfer, block_bytes());
}

template <class Use>
void Stepper::respond(const LateralField::Values& stress, Strains strains, Use use) {
    Block* force = pencil_.data();
    planes_->set(stress);
    each_pencil(strains, [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t at) {
        std::fill(pencil_.begin(), pencil_.end(), Block{});
        add_planes_force(row, block, force);
        operator_.solve_implicit(factor(at), force);
        slab_bodies_.hold(row, block, background_solve(), force);
        if (!bodies_->empty()) bodies_->evaluate(row, block, force);
        clock_.lap(Phase::solves, pencil_bytes(0.0));
        use(row, block, at, force);
    });
}

void Stepper::strain_of(const LateralField::Values& stress, LateralField::Values& strain) {
    respond(stress, Strains::needed,
            [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t /*pencil*/,
                const Block* displacement) { put_strain(row, block, displacement); });
    planes_->get(strain);
    if (bodies_->empty()) return;
    bodies_->respond();
    each_reaction({});
    add_planes(strain);
}

void Stepper::displace(const LateralField::Values& stress) {
    const double scale = first_step_scale();
    double work = 0.0;
    const auto add = [&](std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil,
                         const Block* displacement) {
        Block pressure[parts];
        load_.put(row, block, pressure);
        work += add_to_next(row, block, pencil, scale, displacement, pressure);
    };
    respond(stress, Strains::unused, add); // their strain is known
    if (!bodies_->empty()) {
        bodies_->respond();
        bodies_->add_to_next(scale);
        each_reaction(add);
    }
    watch_.add_work(scale * work);
}

double Stepper::add_to_next(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t pencil,
                            double scale, const Block* displacement, const Block* pressure) {
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    kernels_.add_scaled(size, scale, displacement, before_.data() + pencil * size);
    return work_of_change(row, block, scale, displacement, pressure);
}

double Stepper::work_of_change(std::ptrdiff_t row, std::ptrdiff_t block, double scale,
                               const Block* displacement, const Block* pressure) const {
    return work_of(vectors_.counted(row, block), pressure,
                   [&](std::ptrdiff_t p, std::ptrdiff_t lane) {
                       return 0.5 * scale * displacement[parts + p][lane];
                   });
}

double Stepper::block_bytes() const {
    return static_cast<double>(planes_->count() * parts) * sizeof(Block);
}

double Stepper::pencil_bytes(double times) const {
    return (static_cast<double>(operator_.factor_size()) +
            times * static_cast<double>(operator_.unknowns() * parts)) *
           sizeof(Block);
}

double Stepper::value_bytes(double times) const {
    return times * static_cast<double>(field_.size() * sizeof(double));
}

StrainSolver::Responses Stepper::on_plane() {
    return {.full = [this](const auto& stress, auto& strain) { strain_of(stress, strain); },
            .rounded = {}};
}

int Stepper::iterate() {
    const double points = static_cast<double>(case_.domain.nx * case_.domain.ny);
    // The products are sums over cells, the reference is per area. The tolerance refers to the
    // motion and not to d; otherwise it would be too loose while a load begins and too strict after
    // it ends.
    const StrainSolver::Outcome outcome =
        solver_->solve(change_, points * reference_, tolerance_, box_ ? on_box() : on_plane());
    if (!outcome.converged)
        throw CaseFailure(fmt::format(
            "step {} at {:.4g} ms: conjugate gradients did not converge in {} iterations; a "
            "shorter solver.spectral.time_step_us or a smaller contrast_cap may help",
            step_, 1e3 * static_cast<double>(step_) * step_s_, outcome.iterations));
    statistics_.iterations += outcome.iterations;
    statistics_.most_iterations = std::max(statistics_.most_iterations, outcome.iterations);
    for (std::size_t i = 0; i < change_.size(); ++i)
        change_[i] += solver_->strain()[i];
    return outcome.iterations;
}

void Stepper::advance_strains() {
    const double scale = first_step_scale();
    strain_kernels_.advance(std::ssize(change_), scale, strain_.data(), change_.data(),
                            strain_before_.data());
    std::swap(strain_, strain_before_);
    clock_.lap(Phase::products, value_bytes(4.0));
}

DistributedRows Stepper::state_rows() const {
    const fft::SlabShare& share = slabs_.share();
    return {.total = case_.domain.ny / 2 + 1,
            .start = share.ky_start,
            .count = share.ky_count,
            .row_length = vectors_.blocks() * operator_.unknowns() * parts * lane_count};
}

void Stepper::save(StateWriter& state) const {
    state.put("step", static_cast<double>(step_));
    state.put("iterations", static_cast<double>(statistics_.iterations));
    state.put("most_iterations", statistics_.most_iterations);
    watch_.save(state);
    state.put("now", state_rows(), scalars(now_.data()));
    state.put("before", state_rows(), scalars(before_.data()));
    bodies_->save(state);
    if (field_.variation().empty()) return;
    const DistributedRows rows = field_.rows(case_.domain.nx);
    state.put("strain", rows, field_.to_rows(strain_).data());
    state.put("strain_before", rows, field_.to_rows(strain_before_).data());
}

void Stepper::restore(const StateReader& state) {
    step_ = std::lround(state.get("step"));
    statistics_.steps = step_;
    statistics_.iterations = std::lround(state.get("iterations"));
    statistics_.most_iterations = static_cast<int>(std::lround(state.get("most_iterations")));
    watch_.restore(state);
    state.get("now", state_rows(), scalars(now_.data()));
    state.get("before", state_rows(), scalars(before_.data()));
    predicted_.valid = false;
    bodies_->restore(state);
    if (field_.variation().empty()) return;
    const DistributedRows rows = field_.rows(case_.domain.nx);
    std::vector<double> buffer(static_cast<std::size_t>(rows.count * rows.row_length));
    state.get("strain", rows, buffer.data());
    field_.from_rows(buffer, strain_);
    state.get("strain_before", rows, buffer.data());
    field_.from_rows(buffer, strain_before_);
}

} // namespace shearwake::spectral
