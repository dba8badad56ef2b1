// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/lump_bodies.hpp"

#include <algorithm>

namespace shearwake::spectral {
namespace {

/// Lateral distances of two kernels that overlap.
constexpr std::ptrdiff_t reach = kernel_points - 1, distances = 2 * reach + 1;

/// Number of distances from 0 between the points of all markers along an axis, at most half of the
/// periodic domain.
std::ptrdiff_t distances_along(const std::vector<LumpBodies::Marker>& markers,
                               std::ptrdiff_t LumpBodies::Marker::*at, std::ptrdiff_t points) {
    const auto [low, high] =
        std::minmax_element(markers.begin(), markers.end(),
                            [&](const auto& a, const auto& b) { return a.*at < b.*at; });
    return std::min((*high).*at - (*low).*at + reach, points / 2) + 1;
}

/// Sum over both kernels of the weights at each distance.
std::array<double, distances> overlap(const std::array<double, kernel_points>& to,
                                      const std::array<double, kernel_points>& from) {
    std::array<double, distances> sum{};
    for (std::ptrdiff_t i = 0; i < kernel_points; ++i)
        for (std::ptrdiff_t j = 0; j < kernel_points; ++j)
            sum[static_cast<std::size_t>(j - i + reach)] +=
                from[static_cast<std::size_t>(i)] * to[static_cast<std::size_t>(j)];
    return sum;
}

/// The displacements at distances (x, y) >= 0 and depths from `depth` on due to a unit force at
/// that depth: [x][plane - 3 depth][y], on all ranks.
class Responses {
public:
    Responses(const std::vector<LumpBodies::Marker>& markers,
              const std::vector<DepthWeights>& depths, const Domain& domain, const DepthMesh& mesh,
              const WaveVectors& vectors, const fft::SlabTransform& slabs, const Comm& team)
        : domain_(domain), vectors_(vectors), team_(team),
          nx_(distances_along(markers, &LumpBodies::Marker::x, domain.nx)),
          ny_(distances_along(markers, &LumpBodies::Marker::y, domain.ny)),
          rows_(std::clamp<std::ptrdiff_t>(nx_ - slabs.share().x_start, 0, slabs.share().x_count)),
          depths_(depths.size()), planes_(depths, runs(), mesh, vectors, slabs, team),
          values_(planes_.size()) {}

    void compute(std::size_t depth, std::size_t component, const VerticalOperator& op,
                 const RigidBodies::Solve& solve) {
        fft::AlignedVector<Block> pencil(static_cast<std::size_t>(op.unknowns() * parts));
        const double per_area = 1.0 / (domain_.extent_x_m() * domain_.extent_y_m());
        for (std::ptrdiff_t row = 0; row < vectors_.rows(); ++row) {
            for (std::ptrdiff_t block = 0; block < vectors_.blocks() && !vectors_.is_nyquist(row);
                 ++block) {
                std::fill(pencil.begin(), pencil.end(), Block{});
                planes_.add_unit(row, block, depth, component, per_area, pencil.data());
                solve(row, block, pencil.data());
                planes_.evaluate(row, block, pencil.data());
            }
            planes_.end_row(row, depth);
        }
        planes_.get(values_, depth);
        from_ = depth;
        force_ = component;
        std::vector<double> mine;
        for (std::ptrdiff_t i = 0; i < rows_; ++i)
            for (std::size_t d = depth; d < depths_; ++d)
                for (std::size_t c = 0; c < 3; ++c) {
                    const double* row = values_.data() + planes_.first(d) + c * planes_.cells(d) +
                                        static_cast<std::size_t>(i * ny_);
                    mine.insert(mine.end(), row, row + ny_);
                }
        all_ = team_.all_gather(mine);
    }

    /// The displacement of a marker at the same depth or a later one due to a unit force at
    /// another, in the direction of the force.
    std::array<double, 3> between(const LumpBodies::Marker& to,
                                  const LumpBodies::Marker& from) const {
        const auto x = overlap(to.along_x, from.along_x), y = overlap(to.along_y, from.along_y);
        std::array<double, 3> sum{};
        for (std::ptrdiff_t i = 0; i < distances; ++i) {
            const Distance dx = reduced(to.x - from.x + i - reach, domain_.nx);
            double of_line[3] = {};
            for (std::ptrdiff_t j = 0; j < distances; ++j) {
                const Distance dy = reduced(to.y - from.y + j - reach, domain_.ny);
                const double weight = y[static_cast<std::size_t>(j)];
                for (std::size_t c = 0; c < 3; ++c) {
                    const bool is_odd = (c == 1) != (force_ == 1);
                    of_line[c] += (is_odd ? dy.sign : 1.0) * weight *
                                  value(dx.points, to.depth, c, dy.points);
                }
            }
            for (std::size_t c = 0; c < 3; ++c) {
                const bool is_odd = (c == 0) != (force_ == 0);
                sum[c] += (is_odd ? dx.sign : 1.0) * x[static_cast<std::size_t>(i)] * of_line[c];
            }
        }
        return sum;
    }

private:
    /// The magnitude and the sign of a distance in the periodic domain.
    struct Distance {
        std::ptrdiff_t points;
        double sign;
    };
    static Distance reduced(std::ptrdiff_t distance, std::ptrdiff_t period) {
        distance = (distance % period + period) % period;
        if (2 * distance <= period) return {distance, 1.0};
        return {period - distance, -1.0};
    }
    double value(std::ptrdiff_t x, std::size_t depth, std::size_t c, std::ptrdiff_t y) const {
        const std::size_t planes = 3 * (depths_ - from_);
        return all_[(static_cast<std::size_t>(x) * planes + 3 * (depth - from_) + c) *
                        static_cast<std::size_t>(ny_) +
                    static_cast<std::size_t>(y)];
    }
    DisplacementPlanes::Runs runs() const {
        std::vector<fft::RowRun> of_depth;
        for (std::ptrdiff_t i = 0; i < rows_; ++i)
            of_depth.push_back({i, 0, ny_, static_cast<std::size_t>(i * ny_)});
        return DisplacementPlanes::Runs(depths_, of_depth);
    }

    Domain domain_;
    WaveVectors vectors_;
    Comm team_;
    std::ptrdiff_t nx_, ny_, rows_; // distances along x and y; those of this rank
    std::size_t depths_;
    DisplacementPlanes planes_;
    std::vector<double> values_, all_;
    std::size_t from_ = 0, force_ = 0;
};

} // namespace

/// Fills this rank's columns of G = J B^-1 J'.
void LumpBodies::put_responses(const VerticalOperator& op, const Solve& solve) {
    Responses responses(markers_, depths_, domain_, mesh_, vectors_, slabs_, team());
    std::size_t begin = 0; // of the markers of a depth
    for (std::size_t depth = 0; depth < depths_.size(); ++depth) {
        std::size_t end = begin;
        while (end < markers_.size() && markers_[end].depth == depth)
            ++end;
        for (std::size_t component = 0; component < 3; ++component) {
            responses.compute(depth, component, op, solve);
            for (std::size_t from = begin; from < end; ++from)
                for (std::size_t to = begin; to < markers_.size(); ++to) {
                    const std::size_t column = 3 * from + component;
                    // The response from a later depth is that to it.
                    const bool twice = to >= end;
                    if (!inverse_.is_mine(column) && !(twice && inverse_.is_mine(3 * to))) continue;
                    const auto u = responses.between(markers_[to], markers_[from]);
                    for (std::size_t c = 0; c < 3; ++c) {
                        if (inverse_.is_mine(column)) inverse_.column(column)[3 * to + c] = u[c];
                        if (twice && inverse_.is_mine(3 * to + c))
                            inverse_.column(3 * to + c)[column] = u[c];
                    }
                }
        }
        begin = end;
    }
}

} // namespace shearwake::spectral
