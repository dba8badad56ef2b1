// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/endless_systems.hpp"

#include "base/error.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "fft/slab_transform.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace shearwake::spectral {

EndlessSystems::EndlessSystems(const SectionMarkers& markers, const WaveVectors& vectors,
                               const Comm& team)
    : markers_(markers), vectors_(vectors), team_(team) {
    if (markers.along_x()) {
        for (std::ptrdiff_t kx = first_block(team.rank()) * lane_count;
             kx < first_block(team.rank() + 1) * lane_count; ++kx)
            if (vectors.is_there(kx)) mine_.push_back(kx);
    } else {
        for (std::ptrdiff_t row = 0; row < vectors.rows(); ++row)
            if (!vectors.is_nyquist(row)) mine_.push_back(vectors.share().ky_start + row);
    }
}

/// Four unit forces are solved for at once, in the four parts of a pencil. U, W and V of equal |k|
/// respond independently of the direction, and V independently of the others.
void EndlessSystems::respond(const VerticalOperator& op, const Solve& solve, std::ptrdiff_t row,
                             std::ptrdiff_t block) {
    const MarkerArrays a = markers_.arrays();
    Response& r = response_;
    const std::ptrdiff_t levels = op.levels();
    const auto each_node = [&](std::ptrdiff_t depth, auto use) {
        const MarkerDepth& at = a.depth[depth];
        for (std::ptrdiff_t j = 0; j < a.nodes && at.first + j < levels; ++j)
            use(at.weights[j], 2 * (at.first + j) * parts, (2 * levels + at.first + j) * parts);
    };
    for (std::ptrdiff_t from = 0; from < 2 * a.depths; from += parts) {
        const std::ptrdiff_t count = std::min(parts, 2 * a.depths - from);
        std::fill(r.pencil.begin(), r.pencil.end(), Block{});
        for (std::ptrdiff_t p = 0; p < count; ++p)
            each_node((from + p) / 2, [&](double weight, std::ptrdiff_t uw, std::ptrdiff_t v) {
                const bool on_w = (from + p) % 2 == 1;
                add_scaled(weight, block_of(1.0),
                           r.pencil[static_cast<std::size_t>(uw + p + (on_w ? parts : 0))]);
                if (!on_w)
                    add_scaled(weight, block_of(1.0), r.pencil[static_cast<std::size_t>(v + p)]);
            });
        solve(row, block, r.pencil.data());
        for (std::ptrdiff_t p = 0; p < count; ++p)
            for (std::ptrdiff_t depth = 0; depth < a.depths; ++depth) {
                Block u{}, w{}, v{};
                each_node(depth, [&](double weight, std::ptrdiff_t of_uw, std::ptrdiff_t of_v) {
                    add_scaled(weight, r.pencil[static_cast<std::size_t>(of_uw + p)], u);
                    add_scaled(weight, r.pencil[static_cast<std::size_t>(of_uw + parts + p)], w);
                    add_scaled(weight, r.pencil[static_cast<std::size_t>(of_v + p)], v);
                });
                const auto at = static_cast<std::size_t>((from + p) / 2 * a.depths + depth);
                const bool on_w = (from + p) % 2 == 1;
                r.of[on_w ? Response::uw : Response::uu][at] = u;
                r.of[on_w ? Response::ww : Response::wu][at] = w;
                if (!on_w) r.of[Response::vv][at] = v;
            }
    }
}

/// Adds what the wave vectors (k_along, k_across) and (k_along, -k_across) contribute to the lower
/// triangle of the system of k_along. With u_x = i X, u_y = i Y and the factor 1/i of the component
/// along the axis, what is even in k_across is multiplied by cos, the rest by sin of k_across times
/// the distance across.
void EndlessSystems::add_lane(std::ptrdiff_t row, std::ptrdiff_t block, std::ptrdiff_t lane,
                              double* matrix) {
    const WaveBlock waves = vectors_.waves(row, block);
    const bool x = markers_.along_x();
    const double k = waves.k[lane];
    const double k_along = x ? waves.kx[lane] : waves.ky, k_across = x ? waves.ky : waves.kx[lane];
    // The direction of x where k = 0, as in the kernels.
    const double c = k > 0.0 ? k_along / k : (x ? 1.0 : 0.0);
    const double s = k > 0.0 ? k_across / k : (x ? 0.0 : 1.0);
    const double times = (k_across > 0.0 ? 2.0 : 1.0) / markers_.across_extent_m();
    Response& r = response_;
    const Block* phase = markers_.phases(row, block);
    const auto count = static_cast<std::size_t>(markers_.count());
    for (std::size_t i = 0; i < count; ++i) {
        r.cosine[i] = phase[2 * i][lane];
        r.sine[i] = phase[2 * i + 1][lane];
    }
    const auto depths = static_cast<std::size_t>(markers_.arrays().depths);
    const std::size_t n = unknowns();
    for (std::size_t from = 0; from < count; ++from) {
        for (std::size_t to = from; to < count; ++to) {
            const std::size_t at = markers_.depth_of(from) * depths + markers_.depth_of(to);
            const auto response = [&](Response::Kind kind) { return r.of[kind][at][lane]; };
            const double even = times * (r.cosine[to] * r.cosine[from] + r.sine[to] * r.sine[from]);
            const double odd = times * (r.sine[to] * r.cosine[from] - r.cosine[to] * r.sine[from]);
            const double uu = response(Response::uu), vv = response(Response::vv);
            double* first = matrix + from * marker_components * n + to * marker_components;
            first[along] += even * (c * c * uu + s * s * vv);
            first[across] -= odd * c * s * (uu - vv);
            first[down] += even * c * response(Response::wu);
            double* second = first + n;
            second[along] += odd * c * s * (uu - vv);
            second[across] += even * (s * s * uu + c * c * vv);
            second[down] += odd * s * response(Response::wu);
            double* third = second + n;
            third[along] += even * c * response(Response::uw);
            third[across] -= odd * s * response(Response::uw);
            third[down] += even * response(Response::ww);
        }
    }
}

namespace {

/// The inverse of a symmetric positive definite matrix given by its lower triangle.
fft::AlignedVector<double> inverse_of(const Eigen::MatrixXd& lower) {
    const Eigen::LLT<Eigen::MatrixXd, Eigen::Lower> factor(lower);
    if (factor.info() != Eigen::Success || !(factor.rcond() > 1e-13))
        throw CaseFailure("the forces at the surfaces of the rigid bodies are not determined; the "
                          "bodies may be too close to each other or to the surface, or "
                          "domain.spacing_mm too large");
    const Eigen::MatrixXd inverse =
        factor.solve(Eigen::MatrixXd::Identity(lower.rows(), lower.cols()));
    return {inverse.data(), inverse.data() + inverse.size()};
}

} // namespace

void EndlessSystems::assemble(const VerticalOperator& op, const Solve& solve) {
    inverses_.clear();
    Response& r = response_;
    const auto depths = static_cast<std::size_t>(markers_.arrays().depths);
    r.pencil.resize(static_cast<std::size_t>(op.unknowns() * parts));
    for (auto& values : r.of)
        values.resize(depths * depths);
    r.cosine.resize(static_cast<std::size_t>(markers_.count()));
    r.sine = r.cosine;
    if (markers_.along_x())
        assemble_blocks(op, solve);
    else
        assemble_rows(op, solve);
    response_ = {};
}

void EndlessSystems::assemble_rows(const VerticalOperator& op, const Solve& solve) {
    const auto n = static_cast<Eigen::Index>(unknowns());
    for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
        if (vectors_.is_nyquist(row)) continue;
        Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n, n);
        for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
            respond(op, solve, row, block);
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                if (vectors_.is_there(block * lane_count + lane))
                    add_lane(row, block, lane, system.data());
        }
        inverses_.push_back(inverse_of(system));
    }
}

/// The rows of a system are distributed over the ranks, so each system is summed over them.
void EndlessSystems::assemble_blocks(const VerticalOperator& op, const Solve& solve) {
    const std::size_t n = unknowns();
    std::vector<double> systems(lane_count * n * n);
    for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block) {
        std::fill(systems.begin(), systems.end(), 0.0);
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
            if (vectors_.is_nyquist(row)) continue;
            respond(op, solve, row, block);
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
                add_lane(row, block, lane, systems.data() + static_cast<std::size_t>(lane) * n * n);
        }
        team_.sum(std::span<double>(systems));
        const int rank = team_.rank();
        if (block < first_block(rank) || block >= first_block(rank + 1)) continue;
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
            if (vectors_.is_there(block * lane_count + lane))
                inverses_.push_back(inverse_of(Eigen::Map<const Eigen::MatrixXd>(
                    systems.data() + static_cast<std::size_t>(lane) * n * n,
                    static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(n))));
    }
}

SectionMarkers::SectionMarkers(const RigidPlan& plan, const DepthMesh& mesh,
                               const WaveVectors& vectors)
    : vectors_(vectors), nodes_(mesh.degree + 1),
      levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)) {
    place(plan, mesh);
    put_phases();
}

void SectionMarkers::place(const RigidPlan& plan, const DepthMesh& mesh) {
    const std::vector<Body>& bodies = plan.bodies;
    const Domain& domain = plan.c.domain;
    smoothing_m_ = marker_smoothing * domain.spacing_m;
    along_x_ = !bodies.empty() && endless_along(bodies[0], domain) == Endless::along_x;
    across_extent_m_ = along_x_ ? domain.extent_y_m() : domain.extent_x_m();
    for (std::size_t i = 0; i < bodies.size(); ++i) {
        const Vec3 centre = bodies[i].centre_m;
        const Bounds box = bounds(bodies[i]);
        const double high_m = level_spacing_m(mesh, box.low_m.z, box.high_m.z);
        for (const SectionMarker& m : section_markers(bodies[i], endless_along(bodies[i], domain),
                                                      domain.spacing_m, high_m)) {
            const double depth_m = centre.z + m.down_m;
            // The base holds what reaches it.
            if (depth_m > mesh.ends_m.back() - 0.3 * high_m) continue;
            markers_.push_back(
                {i, m.across_m, m.down_m,
                 m.across_m + (along_x_ ? centre.y - domain.y_m(0) : centre.x - domain.x_m(0)),
                 depth_m});
        }
    }
    std::stable_sort(markers_.begin(), markers_.end(),
                     [](const Marker& a, const Marker& b) { return a.depth_m < b.depth_m; });
    std::vector<double> depths_m;
    for (std::size_t i = 0; i < markers_.size(); ++i) {
        const double depth_m = markers_[i].depth_m;
        if (depths_m.empty() || depth_m != depths_m.back()) {
            const DepthWeights at = depth_weights(mesh, depth_m);
            weights_.insert(weights_.end(), at.weights.begin(), at.weights.end());
            depths_m.push_back(depth_m);
            depths_.push_back({.first = at.first,
                               .weights = nullptr,
                               .begin = static_cast<std::ptrdiff_t>(i),
                               .end = 0});
        }
        depths_.back().end = static_cast<std::ptrdiff_t>(i) + 1;
        depth_of_.push_back(depths_.size() - 1);
    }
    for (std::size_t d = 0; d < depths_.size(); ++d)
        depths_[d].weights = weights_.data() + d * static_cast<std::size_t>(nodes_);
}

void SectionMarkers::put_phases() {
    const auto smooth = [&](double k) { return std::exp(-0.5 * std::pow(k * smoothing_m_, 2)); };
    if (along_x_) {
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row)
            for (const Marker& m : markers_) {
                const double k = vectors_.ky_rad_m(row);
                phases_.push_back(block_of(smooth(k) * std::cos(k * m.at_m)));
                phases_.push_back(block_of(smooth(k) * std::sin(k * m.at_m)));
            }
        return;
    }
    for (std::ptrdiff_t block = 0; block < vectors_.blocks(); ++block)
        for (const Marker& m : markers_) {
            Block cosine{}, sine{};
            for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
                const std::ptrdiff_t i = block * lane_count + lane;
                if (!vectors_.is_there(i)) continue;
                const double k = vectors_.kx_rad_m(i);
                cosine[lane] = smooth(k) * std::cos(k * m.at_m);
                sine[lane] = smooth(k) * std::sin(k * m.at_m);
            }
            phases_.push_back(cosine);
            phases_.push_back(sine);
        }
}

MarkerArrays SectionMarkers::arrays() const {
    // Along x the wave vector (kx, -ky) is the conjugate of the stored (-kx, ky), and the component
    // along the axis, which is divided by i, changes its sign.
    const double s = along_x_ ? -1.0 : 1.0;
    return {.nodes = nodes_,
            .levels = levels_,
            .depths = std::ssize(depths_),
            .depth = depths_.data(),
            .along_x = along_x_,
            .mirrored_re = {s, 1.0, 1.0},
            .mirrored_im = {1.0, s, s}};
}

Block SectionMarkers::mirrored(std::ptrdiff_t row, std::ptrdiff_t block) const {
    if (along_x_) return block_of(vectors_.share().ky_start + row == 0 ? 0.0 : 1.0);
    Block counts = block_of(1.0);
    if (block == 0) counts[0] = 0.0;
    return counts;
}

double endless_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks) {
    const Domain& domain = plan.c.domain;
    const SectionMarkers markers(plan, mesh, WaveVectors(domain, {}));
    const double parts_of = static_cast<double>(markers.count() * marker_components);
    const double columns = std::ceil(static_cast<double>(domain.nx) / (2.0 * lane_count));
    const auto rows = static_cast<double>(fft::most_rows(domain.ny, ranks));
    const double systems = markers.along_x() ? lane_count * std::ceil(columns / ranks) : rows;
    // Systems, phases, and the values at the markers.
    const double blocks = markers.along_x() ? rows + 3.0 * columns : columns + 3.0;
    return sizeof(double) * parts_of * (systems * parts_of + 2.0 * rows) +
           sizeof(Block) * parts_of * blocks;
}

} // namespace shearwake::spectral
