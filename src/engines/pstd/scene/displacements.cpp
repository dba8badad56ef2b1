// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scene/displacements.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string>

namespace shearwake::pstd {

Displacement::Displacement(Field velocity, const Scheme& scheme, std::ptrdiff_t first_z,
                           std::ptrdiff_t planes)
    : slabs_(scheme.slabs()), planes_(planes), tally_(scheme.tally({.quantity = velocity,
                                                                    .first_z = first_z,
                                                                    .planes = planes,
                                                                    .scale = slabs_.grid.dt_s})) {}

void Displacement::sum(std::span<const double> weights, std::span<double> plane_m,
                       std::ptrdiff_t from_plane) const {
    const std::vector<double>& values_m = tally_->values();
    for (std::size_t row = 0; row < plane_m.size(); ++row) {
        const double* values = values_m.data() + static_cast<std::ptrdiff_t>(row) * planes_;
        double sum = 0.0;
        for (std::size_t k = 0; k < weights.size(); ++k)
            sum += weights[k] * values[from_plane + static_cast<std::ptrdiff_t>(k)];
        plane_m[row] = sum;
    }
}

double Displacement::largest_m(const Comm& team) const {
    double largest = 0.0;
    for (const double value : tally_->values())
        largest = std::isfinite(value) ? std::max(largest, std::abs(value))
                                       : std::numeric_limits<double>::infinity();
    return team.max(largest);
}

DistributedRows Displacement::rows() const {
    return {.total = slabs_.nx(),
            .start = slabs_.x_start(),
            .count = slabs_.x_count(),
            .row_length = slabs_.ny() * planes_};
}

void Displacement::save(StateWriter& state, const std::string& name) const {
    state.put(name, rows(), tally_->values().data());
}

void Displacement::restore(const StateReader& state, const std::string& name) {
    std::vector<double> values_m(static_cast<std::size_t>(slabs_.rows() * planes_));
    state.get(name, rows(), values_m.data());
    tally_->restore(values_m);
}

std::vector<double> depth_weights(double depth_m, double spacing_m, SurfacePlane surface) {
    constexpr std::array fitted = {0.8903, 1.2843, -3.1877, 3.0748, -1.0473};
    const double at = depth_m / spacing_m, low = std::floor(at + 1e-9);
    const double share = std::max(at - low, 0.0);
    std::vector<double> weights(static_cast<std::size_t>(low) + 2, 0.0);
    weights[weights.size() - 2] = 1.0 - share;
    weights.back() = share;
    if (share < 1e-9) weights.pop_back();
    if (surface != SurfacePlane::rings || weights.front() == 0.0) return weights;
    const double of_surface = weights.front();
    weights.front() = 0.0;
    weights.resize(std::max(weights.size(), fitted.size()), 0.0);
    for (std::size_t k = 0; k < fitted.size(); ++k)
        weights[k] += of_surface * fitted[k];
    return weights;
}

namespace {

/// Why the field cannot be the solution: a displacement larger than the domain. Empty if it can.
std::string divergence(const Case& c, std::ptrdiff_t frame, double largest_m, double step_s) {
    const double domain_m = std::max(c.domain.extent_x_m(), c.domain.extent_y_m());
    if (largest_m <= domain_m) return "";
    const std::string what =
        std::isfinite(largest_m)
            ? fmt::format("diverges: the displacement of {:.3g} mm exceeds the size of the domain, "
                          "{:.4g} mm,",
                          1e3 * largest_m, 1e3 * domain_m)
            : std::string("is not finite");
    return fmt::format(
        "the field of engine \"pstd\" {} at frame {}, {:.4g} ms: the time step of "
        "{:.4g} us is probably unstable; a smaller solver.pstd.time_step_us may help",
        what, frame, 1e3 * c.time.frame_s(frame), 1e6 * step_s);
}

} // namespace

engines::Slab domain_slab(const Case& c, std::ptrdiff_t first_x, const Slabs& slabs) {
    const auto inside = [&](std::ptrdiff_t x) {
        return std::clamp<std::ptrdiff_t>(x - first_x, 0, c.domain.nx);
    };
    const std::ptrdiff_t start = inside(slabs.x_start());
    return {start, inside(slabs.x_start() + slabs.x_count()) - start};
}

Frames::Frames(const Case& c, FramePlaces places, const Scheme& scheme)
    : c_(c), places_(std::move(places)), slabs_(scheme.slabs()),
      slab_(domain_slab(c, places_.first_x, slabs_)),
      u_z_(Field::uz, scheme, places_.first_z, places_.planes),
      plane_m_(static_cast<std::size_t>(slabs_.rows())) {}

void Frames::emit(std::ptrdiff_t number, engines::Observer& observer, const Comm& team) {
    const std::string why = divergence(c_, number, u_z_.largest_m(team), slabs_.grid.dt_s);
    if (!why.empty()) throw FieldDiverges(why);
    const std::ptrdiff_t ny = slabs_.ny(),
                         first = slab_.x_start + places_.first_x - slabs_.x_start();
    const double* values = plane_m_.data() + (slab_.x_count > 0 ? first * ny + places_.first_y : 0);
    for (std::size_t d = 0; d < places_.weights.size(); ++d) {
        u_z_.sum(places_.weights[d], plane_m_);
        observer.frame({.number = number,
                        .depth = d,
                        .u_z_m = View2<const double>(values, slab_.x_count, c_.domain.ny, ny)});
    }
}

DisplacementVolumes::DisplacementVolumes(const Case& c, const CaseGrid& grid, const Scheme& scheme)
    : c_(c), grid_(grid), slabs_(scheme.slabs()), slab_(domain_slab(c, grid.first_x, slabs_)) {
    if (c.record.volumes_s.empty()) return;
    for (const Field field : {Field::ux, Field::uy})
        lateral_.emplace_back(field, scheme, grid.surface, grid.levels);
}

std::vector<double> DisplacementVolumes::levels_m() const {
    std::vector<double> z_m;
    for (std::ptrdiff_t l = 0; l < grid_.levels && !lateral_.empty(); ++l)
        z_m.push_back(static_cast<double>(l) * grid_.spacing_m);
    return z_m;
}

void DisplacementVolumes::add() {
    for (Displacement& u : lateral_)
        u.add();
}

/// Mean of x - 1/2 and x + 1/2; the row before the first one belongs to another rank.
DisplacementVolumes::Plane DisplacementVolumes::x_mean(const Plane& plane, const Comm& team) const {
    const auto ny = static_cast<std::size_t>(slabs_.ny());
    const std::size_t own = plane.empty() ? 0 : ny;
    const Plane last_rows = team.all_gather(std::span<const double>(plane).last(own));
    if (plane.empty()) return plane;
    std::size_t mine = 0; // position of this rank's row among them
    for (int r = 0; r < slabs_.rank; ++r)
        mine += slabs_.x_count(r) > 0 ? ny : 0;
    const double* before = last_rows.data() + (mine == 0 ? last_rows.size() : mine) - ny;
    Plane mean(plane.size());
    for (std::size_t i = 0; i < plane.size(); ++i)
        mean[i] = 0.5 * ((i < ny ? before[i] : plane[i - ny]) + plane[i]);
    return mean;
}

DisplacementVolumes::Plane DisplacementVolumes::y_mean(const Plane& plane) const {
    const auto ny = static_cast<std::size_t>(slabs_.ny());
    Plane mean(plane.size());
    for (std::size_t i = 0; i < plane.size(); ++i)
        mean[i] = 0.5 * (plane[i % ny == 0 ? i + ny - 1 : i - 1] + plane[i]);
    return mean;
}

void DisplacementVolumes::emit(std::size_t snapshot, const Displacement& u_z,
                               engines::Observer& observer, const Comm& team) const {
    const std::ptrdiff_t ny = slabs_.ny();
    const std::ptrdiff_t first =
        slab_.x_count > 0 ? (slab_.x_start + grid_.first_x - slabs_.x_start()) * ny + grid_.first_y
                          : 0;
    Plane plane(static_cast<std::size_t>(slabs_.rows()));
    for (std::size_t component = 0; component < 3; ++component) {
        for (std::ptrdiff_t level = 0; level < grid_.levels && !lateral_.empty(); ++level) {
            if (component == 2) {
                u_z.sum(std::array{1.0}, plane, level);
            } else {
                const std::array at_skin = {1.5, -0.5}, between = {0.5, 0.5};
                lateral_[component].sum(level == 0 ? at_skin : between, plane,
                                        std::max<std::ptrdiff_t>(level - 1, 0));
                plane = component == 0 ? x_mean(plane, team) : y_mean(plane);
            }
            observer.volume({.snapshot = snapshot,
                             .field = 0,
                             .component = component,
                             .level = static_cast<std::size_t>(level),
                             .values = View2<const double>(plane.data() + first, slab_.x_count,
                                                           c_.domain.ny, ny)});
        }
    }
}

void DisplacementVolumes::save(StateWriter& state) const {
    for (std::size_t i = 0; i < lateral_.size(); ++i)
        lateral_[i].save(state, i == 0 ? "volume_u_x" : "volume_u_y");
}

void DisplacementVolumes::restore(const StateReader& state) {
    for (std::size_t i = 0; i < lateral_.size(); ++i)
        lateral_[i].restore(state, i == 0 ? "volume_u_x" : "volume_u_y");
}

} // namespace shearwake::pstd
