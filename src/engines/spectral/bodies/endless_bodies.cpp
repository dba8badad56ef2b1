// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/endless_bodies.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "simd/kernels.hpp"

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

EndlessBodies::EndlessBodies(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors,
                             double step_s, const Comm& team)
    : bodies_(section_bodies(c)), medium_(c.scene().medium), vectors_(vectors), team_(team),
      step_s_(step_s), markers_(c, mesh, vectors), systems_(markers_, vectors, team),
      kernels_(simd::kernels<MarkerKernels>()) {
    now_.assign(section_freedoms * bodies_.size(), 0.0);
    before_ = acceleration_ = now_;
    for (std::size_t i = 0; i < bodies_.size(); ++i)
        for (std::size_t j = 0;
             j < section_freedoms && held_by(bodies_[i], medium_, c.domain).empty(); ++j)
            free_.push_back(i * section_freedoms + j);
}

/// A part of the motion of a marker: at wavenumber 0 along the axis the displacements are real, and
/// the one along the axis has been divided by i.
double EndlessBodies::rigid(std::size_t marker, std::ptrdiff_t part,
                            const std::vector<double>& q) const {
    const SectionMarkers::Marker& m = markers_.all()[marker];
    const double* of = q.data() + m.body * section_freedoms;
    switch (part) {
    case 2 * along + 1:
        return -of[0];
    case 2 * across:
        return of[1] + m.down_m * of[3];
    case 2 * down:
        return of[2] - m.across_m * of[3];
    default:
        return 0.0;
    }
}

void EndlessBodies::take_mass() {
    mass_.assign(free_.size() * free_.size(), 0.0);
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
        const SectionMass mass = excess_mass(
            bodies_[i], markers_.along_x() ? Endless::along_x : Endless::along_y, medium_);
        for (std::size_t row = 0; row < free_.size(); ++row)
            for (std::size_t column = 0; column < free_.size(); ++column)
                if (free_[row] / section_freedoms == i && free_[column] / section_freedoms == i)
                    mass_[row * free_.size() + column] =
                        mass[free_[row] % section_freedoms * section_freedoms +
                             free_[column] % section_freedoms];
    }
}

void EndlessBodies::assemble(const VerticalOperator& op, const EndlessSystems::Solve& solve) {
    if (empty()) return;
    if (markers_.along_x())
        blocks_.resize(static_cast<std::size_t>(vectors_.blocks() * per_pencil()));
    else
        blocks_.resize(static_cast<std::size_t>(per_pencil()));
    rows_.resize(static_cast<std::size_t>(vectors_.rows() * per_pencil()));
    systems_.assemble(op, solve);
    take_mass();
    if (!team_.is_root() || free_.empty()) return;
    const auto n = static_cast<Eigen::Index>(systems_.unknowns()), freedoms = size_of(free_);
    const Eigen::Map<const Matrix> inverse(systems_.inverse(0), n, n);
    // The motion of the real and of the imaginary parts, one column per degree of freedom.
    Matrix motion[2] = {Matrix::Zero(n, freedoms), Matrix::Zero(n, freedoms)};
    for (Eigen::Index f = 0; f < freedoms; ++f) {
        std::vector<double> unit(now_.size(), 0.0);
        unit[free_[static_cast<std::size_t>(f)]] = 1.0;
        for (Eigen::Index i = 0; i < n; ++i)
            for (Eigen::Index part = 0; part < 2; ++part)
                motion[part](i, f) = rigid(static_cast<std::size_t>(i / marker_components),
                                           2 * (i % marker_components) + part, unit);
    }
    per_freedom_.resize(static_cast<std::size_t>(2 * n * freedoms));
    Matrix stiffness =
        Eigen::Map<const RowMajor>(mass_.data(), freedoms, freedoms) / (step_s_ * step_s_);
    for (Eigen::Index part = 0; part < 2; ++part) {
        Eigen::Map<Matrix> forces(per_freedom_.data() + part * n * freedoms, n, freedoms);
        forces = inverse * motion[part];
        stiffness += motion[part].transpose() * forces;
    }
    const Eigen::LLT<Matrix> factor(stiffness);
    if (factor.info() != Eigen::Success)
        throw CaseFailure(
            "a rigid body is so much lighter than the material that it replaces that "
            "its motion is not stable; give it a higher density_kg_m3 or fixed = true");
    mobility_.resize(free_.size() * free_.size());
    Eigen::Map<Matrix>(mobility_.data(), freedoms, freedoms) =
        factor.solve(Matrix::Identity(freedoms, freedoms));
}

void EndlessBodies::clear() {
    std::fill(blocks_.begin(), blocks_.end(), Block{});
}

void EndlessBodies::begin_forces(std::ptrdiff_t row) {
    if (empty() || markers_.along_x()) return;
    const double* from = rows_.data() + row * per_pencil();
    for (std::ptrdiff_t i = 0; i < per_pencil(); ++i)
        blocks_[static_cast<std::size_t>(i)] = block_of(from[i]);
}

void EndlessBodies::evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil) {
    kernels_.evaluate(markers_.arrays(), vectors_.waves(row, block), markers_.mirrored(row, block),
                      pencil, markers_.phases(row, block), values_of(block));
}

void EndlessBodies::end_row(std::ptrdiff_t row) {
    if (empty() || markers_.along_x()) return;
    double* to = rows_.data() + row * per_pencil();
    for (std::ptrdiff_t i = 0; i < per_pencil(); ++i)
        to[i] = sum_of(blocks_[static_cast<std::size_t>(i)]);
    clear();
}

void EndlessBodies::add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) const {
    const Block* forces =
        markers_.along_x() ? blocks_.data() + block * per_pencil() : blocks_.data();
    kernels_.add_force(markers_.arrays(), vectors_.waves(row, block), forces,
                       markers_.phases(row, block), 1.0 / markers_.across_extent_m(), pencil);
}

std::ptrdiff_t EndlessBodies::place(std::ptrdiff_t system) const {
    if (!markers_.along_x()) return (system - vectors_.share().ky_start) * per_pencil();
    return system / lane_count * per_pencil() * lane_count + system % lane_count;
}

/// Replaces the displacements of a system by its forces.
void EndlessBodies::solve_system(std::size_t index, const std::vector<double>& target,
                                 double scale) {
    const auto n = static_cast<Eigen::Index>(systems_.unknowns());
    const std::ptrdiff_t system = systems_.mine()[index];
    double* at = values() + place(system);
    const auto value = [&](Eigen::Index i, Eigen::Index part) -> double& {
        return at[(2 * i + part) * stride()];
    };
    Matrix missing(n, 2);
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index part = 0; part < 2; ++part) {
            const double goal = system > 0 ? 0.0
                                           : rigid(static_cast<std::size_t>(i / marker_components),
                                                   2 * (i % marker_components) + part, target);
            missing(i, part) = (goal - value(i, part)) / scale;
        }
    Matrix force = Eigen::Map<const Matrix>(systems_.inverse(index), n, n) * missing;
    if (system == 0 && !free_.empty()) {
        const Eigen::Index freedoms = size_of(free_);
        Eigen::VectorXd resultant = Eigen::VectorXd::Zero(freedoms);
        const auto per_freedom = [&](Eigen::Index part) {
            return Eigen::Map<const Matrix>(per_freedom_.data() + part * n * freedoms, n, freedoms);
        };
        for (Eigen::Index part = 0; part < 2; ++part)
            resultant -= per_freedom(part).transpose() * missing.col(part);
        const Eigen::VectorXd acceleration =
            Eigen::Map<const Matrix>(mobility_.data(), freedoms, freedoms) * resultant;
        for (Eigen::Index part = 0; part < 2; ++part)
            force.col(part) += per_freedom(part) * acceleration;
        for (Eigen::Index f = 0; f < freedoms; ++f)
            acceleration_[free_[static_cast<std::size_t>(f)]] = acceleration(f);
    }
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index part = 0; part < 2; ++part)
            value(i, part) = force(i, part);
}

void EndlessBodies::solve(const std::vector<double>& target, double scale) {
    std::fill(acceleration_.begin(), acceleration_.end(), 0.0);
    if (markers_.along_x())
        team_.sum(std::span<double>(scalars(blocks_.data()),
                                    blocks_.size() * static_cast<std::size_t>(lane_count)));
    for (std::size_t index = 0; index < systems_.mine().size(); ++index)
        solve_system(index, target, scale);
    if (markers_.along_x() && team_.size() > 1) {
        const std::ptrdiff_t first = systems_.first_block(team_.rank()),
                             end = systems_.first_block(team_.rank() + 1);
        const std::vector<double> all = team_.all_gather(std::span<const double>(
            scalars(blocks_.data() + first * per_pencil()),
            static_cast<std::size_t>((end - first) * per_pencil() * lane_count)));
        std::copy(all.begin(), all.end(), scalars(blocks_.data()));
    }
    team_.broadcast(acceleration_);
}

void EndlessBodies::advance(double scale) {
    for (std::size_t i = 0; i < now_.size(); ++i)
        before_[i] = 2.0 * now_[i] - before_[i];
    solve(before_, scale);
    add_to_next(scale);
}

void EndlessBodies::respond() {
    solve(std::vector<double>(now_.size(), 0.0), 1.0);
}

void EndlessBodies::add_to_next(double scale) {
    for (std::size_t i = 0; i < now_.size(); ++i)
        before_[i] += scale * acceleration_[i];
}

void EndlessBodies::add_impulse() {
    for (std::size_t i = 0; i < now_.size(); ++i) {
        now_[i] += acceleration_[i];
        before_[i] -= acceleration_[i];
    }
}

double EndlessBodies::twice_kinetic_J_m2() const {
    double sum = 0.0;
    for (std::size_t i = 0; i < free_.size(); ++i)
        for (std::size_t j = 0; j < free_.size(); ++j)
            sum += mass_[i * free_.size() + j] * (now_[free_[i]] - before_[free_[i]]) *
                   (now_[free_[j]] - before_[free_[j]]);
    return empty() ? 0.0 : sum / (step_s_ * step_s_ * markers_.across_extent_m());
}

double EndlessBodies::memory_B() const {
    return markers_.memory_B() + systems_.memory_B() +
           static_cast<double>(blocks_.size() * sizeof(Block) + rows_.size() * sizeof(double));
}

DistributedRows EndlessBodies::state_rows() const { // rank 0 holds both
    const std::ptrdiff_t rows = team_.is_root() ? 2 : 0;
    return {.total = 2, .start = 2 - rows, .count = rows, .row_length = std::ssize(now_)};
}

void EndlessBodies::save(StateWriter& state) const {
    if (empty()) return;
    std::vector<double> both = now_;
    both.insert(both.end(), before_.begin(), before_.end());
    state.put("rigid_bodies", state_rows(), both.data());
}

void EndlessBodies::restore(const StateReader& state) {
    if (empty()) return;
    std::vector<double> both(2 * now_.size());
    state.get("rigid_bodies", state_rows(), both.data());
    team_.broadcast(both);
    std::copy_n(both.begin(), now_.size(), now_.begin());
    std::copy_n(both.begin() + std::ssize(now_), now_.size(), before_.begin());
}

} // namespace shearwake::spectral
