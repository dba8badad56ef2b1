// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "engines/spectral/stepping/stages.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::spectral {
namespace {

/// On complete planes: G = E B^-1 E^T of the iterations is a pass over the pencils, with the forces
/// of the rigid bodies that it requires.
class VariationStage : public Stage {
public:
    explicit VariationStage(StepState& state) : Stage(state), iteration_(state) {}

    void advance() override {
        const auto response = [this](const StepState::Values& stress, StepState::Values& strain) {
            strain_of(stress, strain);
        };
        // d = B^-1 (rhs - E^T S e); its strain is e plus the remaining residual.
        if (iteration_.solve({.full = response, .rounded = {}}) > 0) displace(iteration_.stress());
        iteration_.advance_strains();
    }
    std::vector<engines::Allocation> arrays() const override { return iteration_.arrays(); }
    void save(StateWriter& state) const override { iteration_.save(state); }
    void restore(const StateReader& state) override { iteration_.restore(state); }

private:
    /// Solves B for the force of the planes at every pencil and calls use(pencil, displacement),
    /// then determines the forces of the rigid bodies that this requires.
    template <class Use>
    void respond(const StepState::Values& stress, bool needs_strain, Use use) {
        Block* force = s_.scratch.data();
        s_.planes.set(stress);
        s_.each_pencil({.strain = needs_strain}, [&](const Pencil& p) {
            std::fill(s_.scratch.begin(), s_.scratch.end(), Block{});
            s_.add_planes_force(p, force);
            s_.solve(p, force);
            if (!s_.bodies->empty()) s_.bodies->evaluate(p.row, p.block, force);
            use(p, force);
        });
    }
    /// Apply B^-1 E^T to a stress with the sign of a force: strain_of() computes the strain of the
    /// result, displace() adds the result to the next displacement.
    void strain_of(const StepState::Values& stress, StepState::Values& strain) {
        respond(stress, true, [&](const Pencil& p, const Block* d) { s_.put_strain(p, d); });
        s_.planes.get(strain);
        if (s_.bodies->empty()) return;
        s_.bodies->respond();
        s_.each_reaction({});
        s_.add_planes(strain);
    }
    void displace(const StepState::Values& stress) {
        double work = 0.0;
        const auto add = [&](const Pencil& p, const Block* d) { work += s_.add_to_next(p, d); };
        respond(stress, false, add); // their strain is known
        if (!s_.bodies->empty()) {
            s_.bodies->respond();
            s_.bodies->add_to_next(s_.scale());
            s_.each_reaction(add);
        }
        s_.energy.watch.add_work(s_.scale() * work);
    }

    StrainIteration iteration_;
};

} // namespace

std::unique_ptr<Stage> make_variation(StepState& state) {
    return std::make_unique<VariationStage>(state);
}

StrainIteration::StrainIteration(StepState& state)
    : s_(state), kernels_(simd::kernels<StrainKernels>()) {
    if (!s_.field.variation().iterates) return;
    together(s_.team, [&] { solver_.emplace(s_.field, s_.c.domain.nx, s_.team); });
}

int StrainIteration::solve(const StrainSolver::Responses& respond) {
    if (!solver_) return 0;
    // The products are sums over cells, the reference is per area. The tolerance refers to the
    // motion and not to d; otherwise it would be too loose while a load begins and too strict after
    // it ends.
    const double points = static_cast<double>(s_.c.domain.nx * s_.c.domain.ny);
    const StrainSolver::Outcome outcome =
        solver_->solve(s_.change, points * s_.energy.reference,
                       std::get<SpectralOptions>(s_.c.solver).residual, respond);
    if (!outcome.converged)
        throw CaseFailure(fmt::format(
            "step {} at {:.4g} ms: conjugate gradients did not converge in {} iterations; a "
            "shorter solver.spectral.time_step_us or a smaller contrast_cap may help",
            s_.step, 1e3 * static_cast<double>(s_.step) * s_.step_s, outcome.iterations));
    s_.statistics.iterations += outcome.iterations;
    s_.statistics.most_iterations = std::max(s_.statistics.most_iterations, outcome.iterations);
    for (std::size_t i = 0; i < s_.change.size(); ++i)
        s_.change[i] += solver_->strain()[i];
    return outcome.iterations;
}

void StrainIteration::advance_strains() {
    kernels_.advance(std::ssize(s_.change), s_.scale(), s_.strain.data(), s_.change.data(),
                     s_.strain_before.data());
    std::swap(s_.strain, s_.strain_before);
}

std::vector<engines::Allocation> StrainIteration::arrays() const {
    const LateralVariation& v = s_.field.variation();
    std::size_t values = v.lambda.size() + v.mu.size() + v.viscosity.size() +
                         v.implicit_lambda.size() + v.implicit_mu.size() + v.implicit_mass.size();
    for (const StepState::Values* each : {&s_.strain, &s_.strain_before, &s_.stress, &s_.change})
        values += each->size();
    if (solver_) values += solver_->values();
    return {{"planes of strain", s_.planes.memory_B()},
            {"strain and moduli of cells", static_cast<double>(values * sizeof(double))}};
}

void StrainIteration::save(StateWriter& state) const {
    state.put("iterations", static_cast<double>(s_.statistics.iterations));
    state.put("most_iterations", s_.statistics.most_iterations);
    const DistributedRows rows = s_.field.rows(s_.c.domain.nx);
    state.put("strain", rows, s_.field.to_rows(s_.strain).data());
    state.put("strain_before", rows, s_.field.to_rows(s_.strain_before).data());
}

void StrainIteration::restore(const StateReader& state) {
    s_.statistics.iterations = std::lround(state.get("iterations"));
    s_.statistics.most_iterations = static_cast<int>(std::lround(state.get("most_iterations")));
    const DistributedRows rows = s_.field.rows(s_.c.domain.nx);
    std::vector<double> buffer(static_cast<std::size_t>(rows.count * rows.row_length));
    state.get("strain", rows, buffer.data());
    s_.field.read_rows(buffer, s_.strain);
    state.get("strain_before", rows, buffer.data());
    s_.field.read_rows(buffer, s_.strain_before);
}

} // namespace shearwake::spectral
