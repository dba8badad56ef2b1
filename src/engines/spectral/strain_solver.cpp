#include "engines/spectral/strain_solver.hpp"

#include <algorithm>

namespace shearwake {
namespace {

constexpr int most_iterations = 500;

} // namespace

StrainSolver::StrainSolver(const LateralField& field, std::ptrdiff_t rows, const Comm& team,
                           StepClock& clock)
    : field_(field), team_(team), clock_(clock), sums_(rows) {
    for (auto* values : {&strain_, &direction_, &stress_, &image_})
        values->assign(field.size(), 0.0);
}

StrainSolver::Outcome StrainSolver::solve(Values& residual, double reference, double tolerance,
                                          const Response& respond) {
    std::fill(strain_.begin(), strain_.end(), 0.0);
    std::copy(residual.begin(), residual.end(), direction_.begin());
    for (std::size_t point = 0; point < field_.points(); ++point) {
        field_.implicit(point, direction_, stress_);
        field_.add_product(point, direction_, stress_, sums_);
    }
    clock_.lap(Phase::products, bytes(5.5)); // an array read or written: 1; moduli: 1/2
    const double goal = tolerance * tolerance * reference;
    double norm = sum_over_team();
    int count = 0;
    for (; norm > goal && count < most_iterations; ++count) {
        respond(stress_, image_);
        const double alpha = norm / curvature();
        const double next = step_along(alpha, residual);
        turn(next / norm, residual);
        clock_.lap(Phase::products, bytes(17.5));
        norm = next;
    }
    return {.iterations = count, .converged = norm <= goal};
}

/// And empties them.
double StrainSolver::sum_over_team() {
    clock_.lap(Phase::products);
    const double all = sums_.of(team_);
    sums_.clear();
    clock_.lap(Phase::rest);
    return all;
}

/// The image becomes (1 + G S) direction; its product with S direction.
double StrainSolver::curvature() {
    for (std::size_t point = 0; point < field_.points(); ++point) {
        const auto [begin, end] = field_.range(point);
        for (std::size_t i = begin; i < end; ++i)
            image_[i] = direction_[i] - image_[i];
        field_.add_product(point, image_, stress_, sums_);
    }
    return sum_over_team();
}

/// Moves along the direction; the image becomes S residual. Point by point, while the values are
/// in the cache. The residual's norm.
double StrainSolver::step_along(double alpha, Values& residual) {
    for (std::size_t point = 0; point < field_.points(); ++point) {
        const auto [begin, end] = field_.range(point);
        for (std::size_t i = begin; i < end; ++i) {
            strain_[i] += alpha * direction_[i];
            residual[i] -= alpha * image_[i];
        }
        field_.implicit(point, residual, image_);
        field_.add_product(point, residual, image_, sums_);
    }
    return sum_over_team();
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
