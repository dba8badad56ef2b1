#include "engines/spectral/strain_solver.hpp"

#include <algorithm>
#include <array>

namespace shearwake {
namespace {

constexpr int most_iterations = 500;

} // namespace

StrainSolver::StrainSolver(const LateralField& field, const Comm& team, StepClock& clock)
    : field_(field), team_(team), clock_(clock) {
    for (auto* values : {&strain_, &direction_, &stress_, &image_})
        values->assign(field.size(), 0.0);
}

StrainSolver::Outcome StrainSolver::solve(Values& residual, double reference, double tolerance,
                                          const Response& respond) {
    std::fill(strain_.begin(), strain_.end(), 0.0);
    std::copy(residual.begin(), residual.end(), direction_.begin());
    double first = 0.0;
    for (std::size_t point = 0; point < field_.points(); ++point)
        first += field_.implicit(point, direction_, stress_);
    clock_.lap(Phase::products, bytes(5.5)); // an array read or written: 1; moduli: 1/2
    std::array<double, 2> sums = {reference, first};
    team_.sum(std::span<double>(sums));
    clock_.lap(Phase::rest);
    const double goal = tolerance * tolerance * sums[0];
    double norm = sums[1];
    int count = 0;
    for (; norm > goal && count < most_iterations; ++count) {
        respond(stress_, image_);
        const double alpha = norm / sum_over_team(curvature());
        const double next = sum_over_team(step_along(alpha, residual));
        turn(next / norm, residual);
        clock_.lap(Phase::products, bytes(16.5));
        norm = next;
    }
    return {.iterations = count, .converged = norm <= goal};
}

double StrainSolver::sum_over_team(double mine) {
    clock_.lap(Phase::products);
    const double all = team_.sum(mine);
    clock_.lap(Phase::rest);
    return all;
}

/// (direction, S (1 + G S) direction), with the image's sign.
double StrainSolver::curvature() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < image_.size(); ++i)
        sum += (direction_[i] - image_[i]) * stress_[i];
    return sum;
}

/// Moves along the direction; the image becomes S residual. Point by point, while the values are
/// in the cache. The residual's norm.
double StrainSolver::step_along(double alpha, Values& residual) {
    double norm = 0.0;
    for (std::size_t point = 0; point < field_.points(); ++point) {
        const auto [begin, end] = field_.range(point);
        for (std::size_t i = begin; i < end; ++i) {
            strain_[i] += alpha * direction_[i];
            residual[i] -= alpha * (direction_[i] - image_[i]);
        }
        norm += field_.implicit(point, residual, image_);
    }
    return norm;
}

void StrainSolver::turn(double beta, const Values& residual) {
    for (std::size_t i = 0; i < image_.size(); ++i) {
        direction_[i] = residual[i] + beta * direction_[i];
        stress_[i] = image_[i] + beta * stress_[i];
    }
}

const StrainSolver::Values& StrainSolver::stress() {
    for (std::size_t point = 0; point < field_.points(); ++point)
        field_.implicit(point, strain_, stress_);
    clock_.lap(Phase::products, bytes(2.5));
    return stress_;
}

} // namespace shearwake
