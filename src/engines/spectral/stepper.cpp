#include "engines/spectral/stepper.hpp"

#include "base/error.hpp"
#include "parallel/agree.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake {
namespace {

/// Weights of an element's nodes at reference position x in [-1, 1] (Lagrange).
std::vector<double> weights_at(const GaussLobatto& rule, double x) {
    std::vector<double> weights(rule.nodes.size(), 1.0);
    for (std::size_t i = 0; i < weights.size(); ++i)
        for (std::size_t j = 0; j < weights.size(); ++j)
            if (i != j) weights[i] *= (x - rule.nodes[j]) / (rule.nodes[i] - rule.nodes[j]);
    return weights;
}

} // namespace

Stepper::Stepper(const Case& c, const DepthMesh& mesh, const SlabTransform& slabs, double step_s,
                 const Comm& team)
    : case_(c), mesh_(mesh), slabs_(slabs), team_(team), vectors_(c.domain, slabs.share()),
      step_s_(step_s), tolerance_(std::get<SpectralOptions>(c.solver).residual),
      field_(lateral_variation(c, mesh, vectors_, step_s, team), c.domain.ny, slabs.share()),
      operator_(mesh, field_.variation().background),
      transfer_(mesh, field_.variation().strain_points, field_.variation().components(), vectors_),
      load_(c, vectors_, step_s),
      // Where steps iterate, more often: that says less well what is wrong with the field.
      watch_(team, step_s, field_.variation().iterates ? 1 : 16) {
    together(team, [&] { assemble(); });
}

void Stepper::assemble() {
    const std::ptrdiff_t pencils = vectors_.pencils(), factor_size = operator_.factor_size();
    const std::ptrdiff_t size = operator_.unknowns() * parts * lane_count;
    factors_.resize(static_cast<std::size_t>(pencils * factor_size * lane_count));
    now_.assign(static_cast<std::size_t>(pencils * size), 0.0);
    before_ = now_;
    pencil_.resize(static_cast<std::size_t>(size));
    planes_.assign(static_cast<std::size_t>(transfer_.planes() * slabs_.share().reals), 0.0);
    for (auto* values : {&strain_, &strain_before_, &stress_, &change_})
        values->assign(field_.size(), 0.0);
    if (field_.variation().iterates) solver_.emplace(field_, team_);
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block)
            operator_.factorise_implicit(vectors_.k(row, block), step_s_,
                                         lanes(factors_.data()) +
                                             (row * vectors_.blocks() + block) * factor_size);
}

void Stepper::advance() {
    const LateralVariation& variation = field_.variation();
    load_.sample(step_);
    if (variation.empty()) {
        first_pass();
    } else {
        field_.stress(strain_, strain_before_, 1.0 / step_s_, stress_);
        field_.to_spectra(stress_, slabs_, planes_.data());
        first_pass();
        field_.from_spectra(planes_.data(), slabs_, change_);
        if (variation.iterates) iterate();
        advance_strains();
    }
    std::swap(now_, before_);
    ++step_;
    ++statistics_.steps;
}

void Stepper::first_pass() {
    const double scale = step_ == 0 ? 0.5 : 1.0;
    const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    Lanes* force = lanes(pencil_.data());
    Lanes kinetic{}, work{};
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) continue;
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const std::ptrdiff_t at = row * vectors_.blocks() + block;
            const Lanes* u = lanes(now_.data()) + at * size;
            Lanes* before = lanes(before_.data()) + at * size;
            const Counted counted = vectors_.counted(row, block);
            std::fill(pencil_.begin(), pencil_.end(), 0.0);
            Lanes pressure[parts];
            load_.put(row, block, pressure);
            std::copy_n(pressure, parts, force + parts); // unknown 1: W at the surface
            operator_.add_internal_force(vectors_.k(row, block), 1.0 / step_s_, u, before, force);
            transfer_.add_force(row, block, planes_.data(), per_point, force);
            kinetic += operator_.twice_kinetic(1.0 / step_s_, u, before, counted.part);
            operator_.solve_implicit(lanes(factors_.data()) + at * operator_.factor_size(), force);
            for (std::ptrdiff_t p = 0; p < parts; ++p) // f . (u+ - u-)/2
                work += counted.part[p] * pressure[p] *
                        (u[parts + p] - before[parts + p] + 0.5 * scale * force[parts + p]);
            transfer_.strain(row, block, force, planes_.data());
            for (std::ptrdiff_t i = 0; i < size; ++i)
                before[i] = 2.0 * u[i] - before[i] + scale * force[i];
        }
    }
    for (std::ptrdiff_t p = 0; p < transfer_.planes(); ++p)
        StrainTransfer::clear_nyquist(vectors_, planes_.data() + p * slabs_.share().reals);
    watch_.look(step_, 0.5 * sum_of(kinetic));
    watch_.add_work(scale * sum_of(work));
    reference_ = std::max(sum_of(kinetic), std::abs(sum_of(work)));
}

template <class Use>
void Stepper::respond(const LateralField::Values& stress, Use use) {
    const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
    Lanes* force = lanes(pencil_.data());
    field_.to_spectra(stress, slabs_, planes_.data());
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) continue;
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const std::ptrdiff_t at = row * vectors_.blocks() + block;
            std::fill(pencil_.begin(), pencil_.end(), 0.0);
            transfer_.add_force(row, block, planes_.data(), per_point, force);
            operator_.solve_implicit(lanes(factors_.data()) + at * operator_.factor_size(), force);
            use(row, block, force);
        }
    }
}

void Stepper::strain_of(const LateralField::Values& stress, LateralField::Values& strain) {
    respond(stress, [&](std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* displacement) {
        transfer_.strain(row, block, displacement, planes_.data());
    });
    for (std::ptrdiff_t p = 0; p < transfer_.planes(); ++p)
        StrainTransfer::clear_nyquist(vectors_, planes_.data() + p * slabs_.share().reals);
    field_.from_spectra(planes_.data(), slabs_, strain);
}

void Stepper::displace(const LateralField::Values& stress) {
    const double scale = step_ == 0 ? 0.5 : 1.0;
    const std::ptrdiff_t size = operator_.unknowns() * parts;
    Lanes work{};
    respond(stress, [&](std::ptrdiff_t row, std::ptrdiff_t block, const Lanes* displacement) {
        Lanes* next = lanes(before_.data()) + (row * vectors_.blocks() + block) * size;
        for (std::ptrdiff_t i = 0; i < size; ++i)
            next[i] += scale * displacement[i];
        Lanes pressure[parts];
        load_.put(row, block, pressure);
        const Counted counted = vectors_.counted(row, block);
        for (std::ptrdiff_t p = 0; p < parts; ++p)
            work += counted.part[p] * pressure[p] * 0.5 * scale * displacement[parts + p];
    });
    watch_.add_work(scale * sum_of(work));
}

/// `change_` is E B^-1 rhs and becomes e = E d.
void Stepper::iterate() {
    const double points = static_cast<double>(case_.domain.nx * case_.domain.ny);
    // The products are sums over cells, the reference is per area. Tied to what moves and not to d,
    // which would be lax while a load begins and strict where it is gone.
    const StrainSolver::Outcome outcome =
        solver_->solve(change_, points * reference_, tolerance_,
                       [&](const auto& stress, auto& strain) { strain_of(stress, strain); });
    if (!outcome.converged)
        throw CaseFailure(fmt::format(
            "step {} at {:.4g} ms: conjugate gradients did not converge in {} iterations; a "
            "shorter solver.spectral.time_step_us or a smaller contrast_cap would help",
            step_, 1e3 * static_cast<double>(step_) * step_s_, outcome.iterations));
    statistics_.iterations += outcome.iterations;
    statistics_.most_iterations = std::max(statistics_.most_iterations, outcome.iterations);
    // d = B^-1 (rhs - E^T S e), whose strain is e and what is left of the residual.
    if (outcome.iterations > 0) displace(solver_->stress());
    for (std::size_t i = 0; i < change_.size(); ++i)
        change_[i] += solver_->strain()[i];
}

void Stepper::advance_strains() {
    const double scale = step_ == 0 ? 0.5 : 1.0;
    for (std::size_t i = 0; i < change_.size(); ++i)
        strain_before_[i] = 2.0 * strain_[i] - strain_before_[i] + scale * change_[i];
    std::swap(strain_, strain_before_);
}

StateRows Stepper::state_rows() const {
    const SlabShare& share = slabs_.share();
    return {.total = case_.domain.ny / 2 + 1,
            .start = share.ky_start,
            .count = share.ky_count,
            .row_length = vectors_.blocks() * operator_.unknowns() * parts * lane_count};
}

void Stepper::save(StateWriter& state) const {
    state.put("step", static_cast<double>(step_));
    state.put("iterations", static_cast<double>(statistics_.iterations));
    state.put("most_iterations", statistics_.most_iterations);
    state.put("work_J_m2", watch_.work_J_m2());
    state.put("now", state_rows(), now_.data());
    state.put("before", state_rows(), before_.data());
    if (field_.variation().empty()) return;
    const StateRows rows = field_.rows(case_.domain.nx);
    state.put("strain", rows, field_.to_rows(strain_).data());
    state.put("strain_before", rows, field_.to_rows(strain_before_).data());
}

void Stepper::restore(StateReader& state) {
    step_ = std::lround(state.get("step"));
    statistics_.steps = step_;
    statistics_.iterations = std::lround(state.get("iterations"));
    statistics_.most_iterations = static_cast<int>(std::lround(state.get("most_iterations")));
    watch_.restore(state.get("work_J_m2"));
    state.get("now", state_rows(), now_.data());
    state.get("before", state_rows(), before_.data());
    if (field_.variation().empty()) return;
    const StateRows rows = field_.rows(case_.domain.nx);
    std::vector<double> buffer(static_cast<std::size_t>(rows.count * rows.row_length));
    state.get("strain", rows, buffer.data());
    field_.from_rows(buffer, strain_);
    state.get("strain_before", rows, buffer.data());
    field_.from_rows(buffer, strain_before_);
}

void Stepper::plane_of_u(std::size_t component, std::size_t level, double* plane) const {
    const auto at_level = static_cast<std::ptrdiff_t>(level);
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        const double ky = vectors_.ky_rad_m(row);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Lanes* u = lanes(now_.data()) +
                             (row * vectors_.blocks() + block) * operator_.unknowns() * parts;
            const Lanes kx = vectors_.kx(block), k = vectors_.k(row, block);
            Lanes value[parts] = {};
            if (at_level < operator_.levels()) {
                const Lanes* uw = u + 2 * at_level * parts;
                const Lanes* v = u + (operator_.psv() + at_level) * parts;
                for (std::ptrdiff_t p = 0; p < parts; ++p) {
                    // u_x = i (c U - s V), u_y = i (s U + c V)
                    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                        const double sign = p < minus_re ? 1.0 : -1.0;
                        const double c = k[lane] > 0.0 ? sign * kx[lane] / k[lane] : 1.0;
                        const double s = k[lane] > 0.0 ? ky / k[lane] : 0.0;
                        value[p][lane] = component == 0   ? c * uw[p][lane] - s * v[p][lane]
                                         : component == 1 ? s * uw[p][lane] + c * v[p][lane]
                                                          : uw[parts + p][lane];
                    }
                }
            }
            if (component < 2) {
                const Lanes plus = value[plus_re], minus = value[minus_re];
                value[plus_re] = -value[plus_im];
                value[plus_im] = plus;
                value[minus_re] = -value[minus_im];
                value[minus_im] = minus;
            }
            StrainTransfer::put(vectors_, row, block, plane, value);
        }
    }
    StrainTransfer::clear_nyquist(vectors_, plane);
}

void Stepper::plane_of_w(double depth_m, double* plane) const {
    const auto above = std::upper_bound(mesh_.ends_m.begin(), mesh_.ends_m.end() - 1, depth_m);
    const auto element = static_cast<std::size_t>(above - mesh_.ends_m.begin()) - 1;
    const std::vector<double> weights = weights_at(
        mesh_.rule, 2.0 * (depth_m - mesh_.ends_m[element]) / mesh_.length_m(element) - 1.0);
    const auto first = static_cast<std::ptrdiff_t>(element) * mesh_.degree;
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            const Lanes* u = lanes(now_.data()) +
                             (row * vectors_.blocks() + block) * operator_.unknowns() * parts;
            Lanes w[parts] = {};
            for (std::ptrdiff_t i = 0; i <= mesh_.degree; ++i) {
                const std::ptrdiff_t unknown = 2 * (first + i) + 1;
                if (unknown >= operator_.psv()) continue; // the base rests
                for (std::ptrdiff_t part = 0; part < parts; ++part)
                    w[part] += weights[static_cast<std::size_t>(i)] * u[unknown * parts + part];
            }
            StrainTransfer::put(vectors_, row, block, plane, w);
        }
    }
    StrainTransfer::clear_nyquist(vectors_, plane);
}

} // namespace shearwake
