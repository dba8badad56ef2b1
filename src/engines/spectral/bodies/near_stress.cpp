// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/near_stress.hpp"

#include "medium/bulk_modulus.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace shearwake::spectral {
namespace {

/// Largest distance of a marker from a point whose stress it corrects, in spacings: with the points
/// of its kernel, at most that of GridForces.
constexpr double marker_reach = 8.0;
/// The sum over the points of the patches is accurate from this distance from the surface on, in
/// spacings. It is evaluated there for points that are closer.
constexpr double least_distance = 0.4;

double ratio_at(const Medium& medium, double depth_m) {
    for (std::size_t i = 0; i < medium.layers.size(); ++i)
        if (i + 1 == medium.layers.size() || depth_m <= depths(medium, i).bottom_m) {
            const Material m = material_of(medium.layers[i]);
            return m.lambda_Pa / m.mu_Pa;
        }
    return 0.0;
}

std::vector<Vec3> marker_places(const LumpBodies& lumps) {
    std::vector<Vec3> all;
    for (const LumpBodies::Marker& m : lumps.markers())
        all.push_back(lumps.lumps()[m.body].centre_m + m.offset_m);
    return all;
}

std::vector<double> marker_depths(const LumpBodies& lumps) {
    std::vector<double> all;
    for (const LumpBodies::Marker& m : lumps.markers())
        if (m.depth == all.size()) all.push_back(lumps.lumps()[m.body].centre_m.z + m.offset_m.z);
    return all;
}

/// The distance of two indices on a periodic axis, in [-period/2, period/2].
std::ptrdiff_t nearest_image(std::ptrdiff_t distance, std::ptrdiff_t period) {
    distance = (distance % period + period) % period;
    return 2 * distance > period ? distance - period : distance;
}

} // namespace

NearStress::NearStress(const LumpBodies& lumps, const Medium& medium, const Domain& domain,
                       const DepthMesh& mesh, const fft::SlabShare& share,
                       std::vector<double> depths_m)
    : lumps_(lumps), domain_(domain), share_(share), depths_m_(std::move(depths_m)),
      lambda_per_mu_(ratio_at(medium, lumps.lumps().front().centre_m.z)),
      patches_(surface_patches(lumps.lumps(), lumps.markers(), domain, mesh.ends_m.back())),
      marker_m_(marker_places(lumps)),
      grid_(mesh, domain.spacing_m, lambda_per_mu_, marker_depths(lumps), depths_m_),
      rows_(depths_m_.size()) {
    for (std::size_t depth = 0; depth < depths_m_.size(); ++depth)
        for (const Point& p : points(depth))
            rows_[depth].push_back(row(depth, p));
}

/// The distance of two points of the periodic domain.
Vec3 NearStress::between(Vec3 from_m, Vec3 to_m) const {
    const auto nearest = [](double distance_m, double period_m) {
        return distance_m - period_m * std::nearbyint(distance_m / period_m);
    };
    return {nearest(to_m.x - from_m.x, domain_.extent_x_m()),
            nearest(to_m.y - from_m.y, domain_.extent_y_m()), to_m.z - from_m.z};
}

/// Whether a point is outside all bodies and close to one. Moves it to least_distance.
bool NearStress::moves_out(Vec3& at_m) const {
    for (const Body& body : lumps_.lumps())
        if (volume_fraction(body, body.centre_m + between(body.centre_m, at_m), {}) > 0.5)
            return false;
    double least_m = std::numeric_limits<double>::infinity();
    const SurfacePatches::Face* nearest = nullptr;
    for (const SurfacePatches::Face& face : patches_.faces)
        if (const double distance_m = norm(between(face.at_m, at_m)); distance_m < least_m) {
            least_m = distance_m;
            nearest = &face;
        }
    const double h_m = domain_.spacing_m;
    if (!nearest || least_m > reach * h_m) return false;
    const Vec3 offset_m = between(nearest->at_m, at_m), n = nearest->normal;
    const double height_m = offset_m.x * n.x + offset_m.y * n.y + offset_m.z * n.z;
    if (least_m < 2.0 * least_distance * h_m && height_m < least_distance * h_m)
        at_m = at_m + (least_distance * h_m - height_m) * n;
    return true;
}

std::vector<NearStress::Point> NearStress::points(std::size_t depth) const {
    std::vector<Point> all;
    const double far_m = reach * domain_.spacing_m;
    std::vector<char> used(static_cast<std::size_t>(share_.reals), 0);
    for (const Body& body : lumps_.lumps()) {
        const Bounds box = bounds(lump_in(body, domain_));
        if (depths_m_[depth] < box.low_m.z - far_m || depths_m_[depth] > box.high_m.z + far_m)
            continue;
        const Vec3 middle_m = 0.5 * (box.low_m + box.high_m),
                   half_m = 0.5 * (box.high_m - box.low_m) + Vec3{far_m, far_m, far_m};
        for (std::ptrdiff_t i = 0; i < share_.x_count; ++i)
            for (std::ptrdiff_t j = 0; j < domain_.ny; ++j) {
                Point p{.place = static_cast<std::size_t>(i * share_.padded_ny + j),
                        .x = share_.x_start + i,
                        .y = j,
                        .at_m = {domain_.x_m(share_.x_start + i), domain_.y_m(j), depths_m_[depth]},
                        .is_near = {}};
                const Vec3 offset_m = between(middle_m, p.at_m);
                if (std::abs(offset_m.x) > half_m.x || std::abs(offset_m.y) > half_m.y ||
                    used[p.place])
                    continue;
                used[p.place] = 1;
                const Vec3 grid_m = p.at_m;
                if (!moves_out(p.at_m)) continue;
                for (const Vec3& marker_m : marker_m_)
                    p.is_near.push_back(norm(between(marker_m, grid_m)) <
                                        marker_reach * domain_.spacing_m);
                all.push_back(std::move(p));
            }
    }
    return all;
}

/// The stress that the engine computes for unit forces at a marker.
ForceStress NearStress::of_grid(std::size_t depth, const Point& point, std::size_t marker) const {
    const LumpBodies::Marker& m = lumps_.markers()[marker];
    ForceStress sum{};
    for (std::ptrdiff_t i = 0; i < kernel_points; ++i)
        for (std::ptrdiff_t j = 0; j < kernel_points; ++j) {
            const double weight =
                m.along_x[static_cast<std::size_t>(i)] * m.along_y[static_cast<std::size_t>(j)];
            const ForceStress one =
                grid_.at(depth, m.depth, nearest_image(point.x - (m.x + i - 1), domain_.nx),
                         nearest_image(point.y - (m.y + j - 1), domain_.ny));
            for (std::size_t f = 0; f < 3; ++f)
                for (std::size_t c = 0; c < strain_components; ++c)
                    sum[f][c] += weight * one[f][c];
        }
    return sum;
}

NearStress::Row NearStress::row(std::size_t depth, const Point& point) const {
    std::vector<Entry> entries(marker_m_.size());
    for (const SurfacePatches::Point& p : patches_.points) {
        const Vec3 r_m = between(p.at_m, point.at_m);
        if (norm(r_m) > (marker_reach + patch_radius + 1.0) * domain_.spacing_m) continue;
        const ForceStress k = kelvin_stress(r_m, lambda_per_mu_);
        for (const SurfacePatches::Share& share : p.shares)
            for (std::size_t f = 0; f < 3; ++f)
                entries[share.marker].weights[f] += share.weight * k[f][zz];
    }
    Row row{point.place, {}};
    row.entries.reserve(
        static_cast<std::size_t>(std::count(point.is_near.begin(), point.is_near.end(), 1)));
    for (std::size_t m = 0; m < entries.size(); ++m) {
        if (!point.is_near[m]) continue;
        const ForceStress of_engine = of_grid(depth, point, m);
        entries[m].marker = m;
        for (std::size_t f = 0; f < 3; ++f)
            entries[m].weights[f] -= of_engine[f][zz];
        row.entries.push_back(entries[m]);
    }
    return row;
}

void NearStress::add_zz(std::size_t depth, const std::vector<double>& forces, double factor,
                        double* plane) const {
    for (const Row& row : rows_[depth]) {
        double sum = 0.0;
        for (const Entry& entry : row.entries)
            for (std::size_t f = 0; f < 3; ++f)
                sum += entry.weights[f] * forces[3 * entry.marker + f];
        plane[row.place] += factor * sum;
    }
}

double near_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks) {
    const LumpSizes sizes = lump_sizes(c, mesh);
    const auto depths = static_cast<double>(stress_depths_m(c).size());
    if (sizes.markers == 0.0 || depths == 0.0) return 0.0;
    // Markers within marker_reach of a point: those of a surface that passes through it.
    const double near = std::min(sizes.markers, 300.0);
    const double points =
        std::min(sizes.points_x + 2.0 * NearStress::reach, static_cast<double>(c.domain.nx)) *
        std::min(sizes.points_y + 2.0 * NearStress::reach, static_cast<double>(c.domain.ny));
    const double of_patch =
        3.2 * std::pow(patch_radius / patch_points, 2) * sizeof(SurfacePatches::Share);
    return GridForces::memory_B(sizes.depths, depths) + sizes.markers * of_patch +
           depths * points * near * 4.0 * sizeof(double) / ranks;
}

} // namespace shearwake::spectral
