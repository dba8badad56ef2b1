// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/endless_bodies.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "parallel/agree.hpp"
#include "simd/kernels.hpp"

#include <Eigen/Dense>
#include <algorithm>

namespace shearwake::spectral {
namespace {

using Matrix = Eigen::MatrixXd;

} // namespace

EndlessBodies::EndlessBodies(const RigidPlan& plan, const DepthMesh& mesh,
                             const WaveVectors& vectors, double step_s, const Comm& team)
    : RigidBodies(plan, section_freedoms, step_s, team), vectors_(vectors),
      markers_(plan, mesh, vectors), systems_(markers_, vectors, team),
      kernels_(simd::kernels<MarkerKernels>()) {}

/// A part of the motion of a marker: at wavenumber 0 along the axis the displacements are real, and
/// the one along the axis has been divided by i.
double EndlessBodies::rigid(std::size_t marker, std::ptrdiff_t part,
                            const std::vector<double>& q) const {
    const SectionMarkers::Marker& m = markers_.markers()[marker];
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

void EndlessBodies::add_mass() {
    std::vector<std::vector<double>> masses;
    for (const Body& body : bodies()) {
        const SectionMass mass =
            excess_mass(body, markers_.along_x() ? Endless::along_x : Endless::along_y, medium());
        masses.emplace_back(mass.begin(), mass.end());
    }
    set_mass(masses, 1.0 / markers_.across_extent_m());
}

void EndlessBodies::assemble(const VerticalOperator& op, const Solve& solve) {
    if (empty()) return;
    if (markers_.along_x())
        blocks_.resize(static_cast<std::size_t>(vectors_.blocks() * per_pencil()));
    else
        blocks_.resize(static_cast<std::size_t>(per_pencil()));
    rows_.resize(static_cast<std::size_t>(vectors_.rows() * per_pencil()));
    systems_.assemble(op, solve);
    add_mass();
    together(team(), [&] {
        if (team().is_root()) prepare_motion(); // it has system 0, the only one that moves
    });
}

void EndlessBodies::prepare_motion() {
    const auto n = static_cast<Eigen::Index>(systems_.unknowns());
    const Eigen::Map<const Matrix> inverse(systems_.inverse(0), n, n);
    // The motion of the real and of the imaginary parts.
    std::vector<double> motion, forces;
    for (std::size_t f = 0; f < free_count(); ++f) {
        const std::vector<double> q = unit(f);
        for (Eigen::Index part = 0; part < 2; ++part) {
            Eigen::VectorXd column(n);
            for (Eigen::Index i = 0; i < n; ++i)
                column(i) = rigid(static_cast<std::size_t>(i / marker_components),
                                  2 * (i % marker_components) + part, q);
            const Eigen::VectorXd force = inverse * column;
            motion.insert(motion.end(), column.begin(), column.end());
            forces.insert(forces.end(), force.begin(), force.end());
        }
    }
    prepare(motion, std::move(forces));
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

void EndlessBodies::add_force(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) {
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
    if (system == 0) move(missing.data(), force.data());
    for (Eigen::Index i = 0; i < n; ++i)
        for (Eigen::Index part = 0; part < 2; ++part)
            value(i, part) = force(i, part);
}

void EndlessBodies::solve(const std::vector<double>& target, double scale) {
    if (markers_.along_x())
        team().sum(std::span<double>(scalars(blocks_.data()),
                                     blocks_.size() * static_cast<std::size_t>(lane_count)));
    for (std::size_t index = 0; index < systems_.mine().size(); ++index)
        solve_system(index, target, scale);
    if (markers_.along_x() && team().size() > 1) {
        const std::ptrdiff_t first = systems_.first_block(team().rank()),
                             end = systems_.first_block(team().rank() + 1);
        const std::vector<double> all = team().all_gather(std::span<const double>(
            scalars(blocks_.data() + first * per_pencil()),
            static_cast<std::size_t>((end - first) * per_pencil() * lane_count)));
        std::copy(all.begin(), all.end(), scalars(blocks_.data()));
    }
    share_acceleration();
}

engines::Allocation EndlessBodies::array() const {
    const std::size_t unknowns = systems_.unknowns();
    return {"endless rigid bodies",
            static_cast<double>((systems_.mine().size() * unknowns * unknowns + rows_.size()) *
                                    sizeof(double) +
                                blocks_.size() * sizeof(Block)) +
                markers_.memory_B()};
}

std::vector<RigidMotion> EndlessBodies::motions() const {
    std::vector<RigidMotion> all;
    for (std::size_t i = 0; i < bodies().size(); ++i) {
        const double* q = position().data() + i * section_freedoms;
        all.push_back(markers_.along_x() ? RigidMotion{{q[0], q[1], q[2]}, {-q[3], 0.0, 0.0}}
                                         : RigidMotion{{q[1], q[0], q[2]}, {0.0, q[3], 0.0}});
    }
    return all;
}

} // namespace shearwake::spectral
