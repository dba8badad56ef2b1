// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/rigid_bodies.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace shearwake::spectral {
namespace {

using Matrix = Eigen::MatrixXd;
using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Eigen::Index size_of(const auto& values) {
    return static_cast<Eigen::Index>(values.size());
}

} // namespace

RigidBodies::RigidBodies(const RigidPlan& plan, std::size_t freedoms, double step_s,
                         const Comm& team)
    : bodies_(plan.bodies), medium_(plan.c.scene.medium), team_(team), step_s_(step_s),
      freedoms_(freedoms) {
    now_.assign(freedoms * bodies_.size(), 0.0);
    before_ = acceleration_ = now_;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        for (std::size_t j = 0;
             j < freedoms && reason_of_rest(bodies_[i], medium_, plan.c.domain).empty(); ++j)
            free_.push_back(i * freedoms + j);
}

void RigidBodies::constrain(std::size_t body, const std::vector<std::size_t>& freedoms) {
    for (const std::size_t freedom : freedoms)
        std::erase(free_, body * freedoms_ + freedom);
}

std::vector<double> RigidBodies::unit(std::size_t free) const {
    std::vector<double> q(now_.size(), 0.0);
    q[free_[free]] = 1.0;
    return q;
}

void RigidBodies::set_mass(const std::vector<std::vector<double>>& masses, double per_area) {
    per_area_ = per_area;
    mass_.assign(free_.size() * free_.size(), 0.0);
    for (std::size_t row = 0; row < free_.size(); ++row)
        for (std::size_t column = 0; column < free_.size(); ++column)
            if (free_[row] / freedoms_ == free_[column] / freedoms_)
                mass_[row * free_.size() + column] =
                    masses[free_[row] / freedoms_]
                          [free_[row] % freedoms_ * freedoms_ + free_[column] % freedoms_];
}

void RigidBodies::prepare(const std::vector<double>& motion, std::vector<double> given) {
    per_freedom_ = std::move(given);
    const Eigen::Index freedoms = size_of(free_);
    if (freedoms == 0) return;
    const Eigen::Index rows = size_of(motion) / freedoms;
    const Eigen::Map<const Matrix> motions(motion.data(), rows, freedoms),
        forces(per_freedom_.data(), rows, freedoms);
    Matrix stiffness =
        Eigen::Map<const RowMajor>(mass_.data(), freedoms, freedoms) / (step_s_ * step_s_);
    stiffness += motions.transpose() * forces;
    const Eigen::LLT<Matrix> factor(stiffness);
    if (factor.info() != Eigen::Success)
        throw CaseFailure(
            "a rigid body is so much lighter than the material that it replaces that "
            "its motion is not stable; give it a higher density_kg_m3 or fixed = true");
    mobility_.resize(free_.size() * free_.size());
    Eigen::Map<Matrix>(mobility_.data(), freedoms, freedoms) =
        factor.solve(Matrix::Identity(freedoms, freedoms));
}

void RigidBodies::move(const double* lack, double* forces) {
    const Eigen::Index freedoms = size_of(free_);
    if (freedoms == 0) return;
    const Eigen::Index rows = size_of(per_freedom_) / freedoms;
    const Eigen::Map<const Matrix> per_freedom(per_freedom_.data(), rows, freedoms);
    const Eigen::VectorXd acceleration =
        Eigen::Map<const Matrix>(mobility_.data(), freedoms, freedoms) *
        (per_freedom.transpose() * -Eigen::Map<const Eigen::VectorXd>(lack, rows));
    Eigen::Map<Eigen::VectorXd>(forces, rows) += per_freedom * acceleration;
    for (Eigen::Index f = 0; f < freedoms; ++f)
        acceleration_[free_[static_cast<std::size_t>(f)]] = acceleration(f);
}

void RigidBodies::advance(double scale) {
    for (std::size_t i = 0; i < now_.size(); ++i)
        before_[i] = 2.0 * now_[i] - before_[i];
    std::fill(acceleration_.begin(), acceleration_.end(), 0.0);
    solve(before_, scale);
    add_to_next(scale);
}

void RigidBodies::respond() {
    std::fill(acceleration_.begin(), acceleration_.end(), 0.0);
    solve(std::vector<double>(now_.size(), 0.0), 1.0);
}

void RigidBodies::add_to_next(double scale) {
    for (std::size_t i = 0; i < now_.size(); ++i)
        before_[i] += scale * acceleration_[i];
}

void RigidBodies::add_impulse() {
    for (std::size_t i = 0; i < now_.size(); ++i) {
        now_[i] += acceleration_[i];
        before_[i] -= acceleration_[i];
    }
}

double RigidBodies::twice_kinetic_J_m2() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < free_.size(); ++i)
        for (std::size_t j = 0; j < free_.size(); ++j)
            sum += mass_[i * free_.size() + j] * (now_[free_[i]] - before_[free_[i]]) *
                   (now_[free_[j]] - before_[free_[j]]);
    return sum * per_area_ / (step_s_ * step_s_);
}

DistributedRows RigidBodies::state_rows() const { // rank 0 holds both
    const std::ptrdiff_t rows = team_.is_root() ? 2 : 0;
    return {.total = 2, .start = 2 - rows, .count = rows, .row_length = std::ssize(now_)};
}

void RigidBodies::save(StateWriter& state) const {
    if (empty()) return;
    std::vector<double> both = now_;
    both.insert(both.end(), before_.begin(), before_.end());
    state.put("rigid_bodies", state_rows(), both.data());
}

void RigidBodies::restore(const StateReader& state) {
    if (empty()) return;
    std::vector<double> both(2 * now_.size());
    state.get("rigid_bodies", state_rows(), both.data());
    team_.broadcast(both);
    std::copy_n(both.begin(), now_.size(), now_.begin());
    std::copy_n(both.begin() + std::ssize(now_), now_.size(), before_.begin());
}

} // namespace shearwake::spectral
