// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/lateral/strain_solver.hpp"

#include "simd/kernels.hpp"

#include <algorithm>
#include <iterator>

namespace shearwake::spectral {
namespace {

constexpr int most_iterations = 500;

} // namespace

StrainSolver::StrainSolver(const LateralField& field, std::ptrdiff_t rows, const Comm& team)
    : kernels_(simd::kernels<StrainKernels>()), field_(field), team_(team), sums_(rows) {
    for (auto* values : {&strain_, &direction_, &stress_, &image_})
        values->assign(field.size(), 0.0);
}

StrainSolver::Outcome StrainSolver::solve(Values& residual, double reference, double tolerance,
                                          const Responses& respond) {
    if (respond.rounded) given_ = residual;
    std::fill(strain_.begin(), strain_.end(), 0.0);
    const double goal = tolerance * tolerance * reference;
    double norm = restart(residual);
    bool may_round = static_cast<bool>(respond.rounded);
    int count = 0;
    while (norm > goal && count < most_iterations) {
        const bool rounds = may_round && count >= full_iterations;
        (rounds ? respond.rounded : respond.full)(stress_, image_);
        const double alpha = norm / curvature();
        const double next = step_along(alpha, residual);
        turn(next / norm, residual);
        norm = next;
        ++count;
        if (!rounds || norm > goal) continue;
        refresh(residual, respond.full);
        norm = restart(residual);
        may_round = false;
    }
    return {.iterations = count, .converged = norm <= goal};
}

double StrainSolver::restart(const Values& residual) {
    std::copy(residual.begin(), residual.end(), direction_.begin());
    for (std::size_t point = 0; point < field_.points(); ++point) {
        field_.implicit(point, direction_, stress_);
        field_.add_product(point, direction_, stress_, sums_);
    }
    return sum_over_team();
}

void StrainSolver::refresh(Values& residual, const Response& respond) {
    respond(stress(), image_);
    for (std::size_t i = 0; i < residual.size(); ++i)
        residual[i] = given_[i] - strain_[i] + image_[i];
}

/// Sums over all ranks and clears the sums.
double StrainSolver::sum_over_team() {
    const double total = sums_.team_sum(team_);
    sums_.clear();
    return total;
}

/// Sets the image to (1 + G S) direction and returns its product with S direction.
double StrainSolver::curvature() {
    for (std::size_t point = 0; point < field_.points(); ++point) {
        const auto [begin, end] = field_.range(point);
        kernels_.subtract_from(static_cast<std::ptrdiff_t>(end - begin), direction_.data() + begin,
                               image_.data() + begin);
        field_.add_product(point, image_, stress_, sums_);
    }
    return sum_over_team();
}

/// Advances along the direction and sets the image to S residual, point by point while the values
/// are in the cache. Returns the norm of the residual.
double StrainSolver::step_along(double alpha, Values& residual) {
    for (std::size_t point = 0; point < field_.points(); ++point) {
        const auto [begin, end] = field_.range(point);
        kernels_.step(static_cast<std::ptrdiff_t>(end - begin), alpha, direction_.data() + begin,
                      image_.data() + begin, strain_.data() + begin, residual.data() + begin);
        field_.implicit(point, residual, image_);
        field_.add_product(point, residual, image_, sums_);
    }
    return sum_over_team();
}

void StrainSolver::turn(double beta, const Values& residual) {
    kernels_.turn(std::ssize(image_), beta, residual.data(), direction_.data());
    kernels_.turn(std::ssize(image_), beta, image_.data(), stress_.data());
}

const StrainSolver::Values& StrainSolver::stress() {
    for (std::size_t point = 0; point < field_.points(); ++point)
        field_.implicit(point, strain_, stress_);
    return stress_;
}

} // namespace shearwake::spectral
