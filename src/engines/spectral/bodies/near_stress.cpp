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
        points_.push_back(find_points(depth));
}

void NearStress::prepare_zz() {
    for (std::size_t depth = 0; depth < depths_m_.size(); ++depth)
        for (const Point& p : points_[depth])
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

std::vector<NearStress::Point> NearStress::find_points(std::size_t depth) const {
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
        static_cast<std::size_t>(std::count(point.is_near.begin(), point.is_near.end(), true)));
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

/// Adds the stress of the forces on the patches.
void NearStress::add_patches(const Point& point, const std::vector<Vec3>& forces,
                             Stress& sum) const {
    for (const SurfacePatches::Point& p : patches_.points) {
        const Vec3 r_m = between(p.at_m, point.at_m);
        if (norm(r_m) > (marker_reach + patch_radius + 1.0) * domain_.spacing_m) continue;
        Vec3 force_N{};
        for (const SurfacePatches::Share& share : p.shares)
            force_N = force_N + share.weight * forces[share.marker];
        if (norm(force_N) == 0.0) continue; // its markers are far away
        const Stress stress = kelvin_stress(r_m, lambda_per_mu_, force_N);
        for (std::size_t c = 0; c < strain_components; ++c)
            sum[c] += stress[c];
    }
}

/// Subtracts the stress that the engine computes for the same forces.
void NearStress::add_grid(std::size_t depth, const Point& point, const std::vector<Vec3>& forces,
                          Stress& sum) const {
    for (std::size_t m = 0; m < forces.size(); ++m) {
        if (!point.is_near[m]) continue;
        const ForceStress unit = of_grid(depth, point, m);
        const Vec3 f = forces[m];
        for (std::size_t c = 0; c < strain_components; ++c)
            sum[c] -= unit[0][c] * f.x + unit[1][c] * f.y + unit[2][c] * f.z;
    }
}

std::vector<NearStress::Correction>
NearStress::corrections(std::size_t depth, const std::vector<double>& forces) const {
    std::vector<Vec3> near_forces(marker_m_.size());
    std::vector<Correction> all;
    for (const Point& p : points_[depth]) {
        Correction correction{p.place, {}};
        for (std::size_t m = 0; m < near_forces.size(); ++m)
            near_forces[m] =
                p.is_near[m] ? Vec3{forces[3 * m], forces[3 * m + 1], forces[3 * m + 2]} : Vec3{};
        add_patches(p, near_forces, correction.stress_Pa);
        add_grid(depth, p, near_forces, correction.stress_Pa);
        all.push_back(correction);
    }
    return all;
}

namespace {

/// Points of the patches per marker.
constexpr double points_per_marker = 10.0;

bool records_tensors(const Case& c) {
    return !c.record.volumes_s.empty() &&
           std::any_of(c.record.volume_fields.begin(), c.record.volume_fields.end(),
                       [](VolumeField field) { return field != VolumeField::u; });
}

/// Points of all levels of a volume that are corrected.
double volume_points(const Case& c, const DepthMesh& mesh) {
    const double far_m = NearStress::reach * c.domain.spacing_m;
    double points = 0.0;
    for (const Body& body : lump_bodies(c)) {
        const Bounds box = bounds(lump_in(body, c.domain));
        const Vec3 length_m = box.high_m - box.low_m + Vec3{2 * far_m, 2 * far_m, 2 * far_m};
        double levels = 0.0;
        for (std::size_t level = 0; level < mesh.clear_levels(); ++level)
            if (std::abs(mesh.z_m(level) - body.centre_m.z) < 0.5 * length_m.z) levels += 1.0;
        // Without the body and the corners, about half of the box.
        points += 0.5 * levels * std::min(length_m.x, c.domain.extent_x_m()) *
                  std::min(length_m.y, c.domain.extent_y_m()) /
                  (c.domain.spacing_m * c.domain.spacing_m);
    }
    return points;
}

} // namespace

double near_stress_pairs(const Case& c, const DepthMesh& mesh) {
    if (!records_tensors(c) || lump_bodies(c).empty()) return 0.0;
    return volume_points(c, mesh) * points_per_marker * lump_sizes(c, mesh).markers;
}

double near_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks) {
    const LumpSizes sizes = lump_sizes(c, mesh);
    const auto depths = static_cast<double>(stress_depths_m(c).size());
    const double volumes_B =
        records_tensors(c)
            ? GridForces::memory_B(sizes.depths, static_cast<double>(mesh.clear_levels())) +
                  volume_points(c, mesh) * (100.0 + sizes.markers / 8.0) / ranks
            : 0.0;
    if (sizes.markers == 0.0 || (depths == 0.0 && volumes_B == 0.0)) return 0.0;
    // Markers within marker_reach of a point: those of a surface that passes through it.
    const double near = std::min(sizes.markers, 300.0);
    const double points =
        std::min(sizes.points_x + 2.0 * NearStress::reach, static_cast<double>(c.domain.nx)) *
        std::min(sizes.points_y + 2.0 * NearStress::reach, static_cast<double>(c.domain.ny));
    const double of_patch =
        3.2 * std::pow(patch_radius / patch_points, 2) * sizeof(SurfacePatches::Share);
    return volumes_B + GridForces::memory_B(sizes.depths, depths) + sizes.markers * of_patch +
           depths * points * near * 4.0 * sizeof(double) / ranks;
}

} // namespace shearwake::spectral
