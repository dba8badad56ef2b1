// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/slab_bodies.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "fft/slab_transform.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

/// Both faces and up to three depths between them, except those at the base.
std::vector<double> constrained_depths_m(const Case& c, const DepthMesh& mesh) {
    std::vector<double> depths_m;
    for (const Body& body : rigid_bodies(c)) {
        if (endless_along(body, c.domain) != Endless::both) continue;
        const Bounds box = bounds(body);
        const double between_m = inner_spacing * level_spacing_m(mesh, box.low_m.z, box.high_m.z);
        const double thickness_m = box.high_m.z - box.low_m.z;
        const long gaps = std::clamp(std::lround(thickness_m / between_m), 1L, 4L);
        for (long i = 0; i <= gaps; ++i) {
            const double depth_m =
                box.low_m.z + thickness_m * static_cast<double>(i) / static_cast<double>(gaps);
            if (depth_m < mesh.ends_m.back() - 0.1 * between_m) depths_m.push_back(depth_m);
        }
    }
    return depths_m;
}

} // namespace

SlabBodies::SlabBodies(const Case& c, const DepthMesh& mesh, const WaveVectors& vectors)
    : vectors_(vectors), levels_(static_cast<std::ptrdiff_t>(mesh.levels()) - 1) {
    for (const double depth_m : constrained_depths_m(c, mesh))
        depths_.push_back(depth_weights(mesh, depth_m));
    values_.resize(static_cast<std::size_t>(size() * parts));
    forces_ = values_;
}

template <class Use>
void SlabBodies::each_node(std::ptrdiff_t constraint, const Use& use) const {
    const std::ptrdiff_t count = std::ssize(depths_);
    const bool on_v = constraint >= 2 * count, on_w = !on_v && constraint >= count;
    const DepthWeights& at = depths_[static_cast<std::size_t>(constraint % count)];
    for (std::ptrdiff_t j = 0; j < std::ssize(at.weights) && at.first + j < levels_; ++j) {
        const std::ptrdiff_t level = at.first + j;
        use(at.weights[static_cast<std::size_t>(j)],
            (on_v ? 2 * levels_ + level : 2 * level + (on_w ? 1 : 0)) * parts);
    }
}

void SlabBodies::evaluate(double scale, const Block* pencil, Block* values) const {
    for (std::ptrdiff_t i = 0; i < size(); ++i)
        each_node(i, [&](double weight, std::ptrdiff_t at) {
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                add_scaled(scale * weight, pencil[at + p], values[i * parts + p]);
        });
}

void SlabBodies::assemble(const VerticalOperator& op, const Solve& solve) {
    if (empty()) return;
    const std::ptrdiff_t uw = 2 * std::ssize(depths_);
    pencil_.resize(static_cast<std::size_t>(op.unknowns() * parts));
    inverses_.resize(static_cast<std::size_t>(vectors_.pencils() * inverse_size()));
    std::vector<Block> matrix(static_cast<std::size_t>(size() * size()));
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
        for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !vectors_.is_nyquist(row);
             ++block) {
            for (std::ptrdiff_t from = 0; from < size(); ++from) {
                std::fill(pencil_.begin(), pencil_.end(), Block{});
                each_node(from, [&](double weight, std::ptrdiff_t at) {
                    add_scaled(weight, block_of(1.0), pencil_[static_cast<std::size_t>(at)]);
                });
                solve(row, block, pencil_.data());
                std::fill(values_.begin(), values_.end(), Block{});
                evaluate(1.0, pencil_.data(), values_.data());
                for (std::ptrdiff_t to = 0; to < size(); ++to)
                    matrix[static_cast<std::size_t>(from * size() + to)] =
                        (from < uw) == (to < uw) ? values_[static_cast<std::size_t>(to * parts)]
                                                 : Block{};
            }
            invert(matrix, vectors_, block,
                   inverses_.data() + (row * vectors_.blocks() + block) * inverse_size());
        }
}

void SlabBodies::invert(const std::vector<Block>& matrix, const WaveVectors& vectors,
                        std::ptrdiff_t block, Block* inverse) const {
    const std::ptrdiff_t uw = 2 * std::ssize(depths_);
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        if (!vectors.is_there(block * lane_count + lane)) continue;
        Block* to = inverse;
        for (const auto& [begin, count] :
             {std::pair(std::ptrdiff_t{0}, uw), std::pair(uw, uw / 2)}) {
            Eigen::MatrixXd of(count, count);
            for (Eigen::Index i = 0; i < count; ++i)
                for (Eigen::Index j = 0; j < count; ++j)
                    of(j, i) =
                        matrix[static_cast<std::size_t>((begin + i) * size() + begin + j)][lane];
            const Eigen::LLT<Eigen::MatrixXd> factor(of);
            if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-13))
                throw CaseFailure("the forces at the faces of the rigid slabs are not determined; "
                                  "the slabs may be too close to each other or to the surface");
            of = factor.solve(Eigen::MatrixXd::Identity(count, count)).eval();
            for (Eigen::Index i = 0; i < of.size(); ++i)
                (*to++)[lane] = of.data()[i];
        }
    }
}

void SlabBodies::respond(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d) {
    const std::ptrdiff_t uw = 2 * std::ssize(depths_);
    const Block* inverse = inverses_.data() + (row * vectors_.blocks() + block) * inverse_size();
    std::fill(forces_.begin(), forces_.end(), Block{});
    for (const auto& [begin, count] : {std::pair(std::ptrdiff_t{0}, uw), std::pair(uw, uw / 2)})
        for (std::ptrdiff_t i = begin; i < begin + count; ++i)
            for (std::ptrdiff_t j = begin; j < begin + count; ++j, ++inverse)
                for (std::ptrdiff_t p = 0; p < parts; ++p)
                    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                        forces_[static_cast<std::size_t>(j * parts + p)][lane] -=
                            (*inverse)[lane] *
                            values_[static_cast<std::size_t>(i * parts + p)][lane];
    std::fill(pencil_.begin(), pencil_.end(), Block{});
    for (std::ptrdiff_t i = 0; i < size(); ++i)
        each_node(i, [&](double weight, std::ptrdiff_t at) {
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                add_scaled(weight, forces_[static_cast<std::size_t>(i * parts + p)],
                           pencil_[static_cast<std::size_t>(at + p)]);
        });
    solve(row, block, pencil_.data());
    for (std::size_t i = 0; i < pencil_.size(); ++i)
        add_scaled(1.0, pencil_[i], d[i]);
}

void SlabBodies::constrain(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d) {
    if (empty()) return;
    std::fill(values_.begin(), values_.end(), Block{});
    evaluate(1.0, d, values_.data());
    respond(row, block, solve, d);
}

void SlabBodies::constrain(std::ptrdiff_t row, std::ptrdiff_t block, const Solve& solve, Block* d,
                           double scale, const Block* u, const Block* before) {
    if (empty()) return;
    std::fill(values_.begin(), values_.end(), Block{});
    evaluate(2.0 / scale, u, values_.data());
    evaluate(-1.0 / scale, before, values_.data());
    evaluate(1.0, d, values_.data());
    respond(row, block, solve, d);
}

double slab_memory_B(const Case& c, const DepthMesh& mesh, int ranks) {
    const auto depths = static_cast<double>(constrained_depths_m(c, mesh).size());
    const double columns = std::ceil(static_cast<double>(c.domain.nx) / (2.0 * lane_count));
    const auto rows = static_cast<double>(fft::most_rows(c.domain.ny, ranks));
    return 5.0 * depths * depths * rows * columns * sizeof(Block);
}

} // namespace shearwake::spectral
