// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"
#include "engines/spectral/bodies/endless_bodies.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "engines/spectral/bodies/stress/near_stress.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

Domain section_of(const Domain& domain, bool along_x) {
    return {along_x ? domain.ny : domain.nx, 1, domain.spacing_m, 0.0};
}

fft::SlabShare section_share(const fft::SlabShare& share, const Domain& section, bool along_x) {
    const std::ptrdiff_t first = along_x ? 0 : share.x_start,
                         count = along_x ? section.nx : share.x_count;
    return {.x_start = first,
            .x_count = count,
            .ky_start = 0,
            .ky_count = 0,
            .padded_ny = 1,
            .reals = count};
}

/// The body with its axis along y through y = 0.
Body turned(Body body, bool along_x) {
    body.centre_m = {along_x ? body.centre_m.y : body.centre_m.x, 0.0, body.centre_m.z};
    const CrossSection section = cross_section(body, along_x ? Endless::along_x : Endless::along_y);
    if (section.is_round)
        body.shape = Cylinder{.radius_m = section.half_down_m, .azimuth_deg = 90.0};
    else
        body.shape = Box{.size_m = {2.0 * section.half_across_m, 1.0, 2.0 * section.half_down_m}};
    return body;
}

Vec3 half_section_m(const Body& turned_body) {
    const CrossSection section = cross_section(turned_body, Endless::along_y);
    return {section.half_across_m, 0.0, section.half_down_m};
}

/// Points of the outline with the lengths that they represent.
std::vector<SurfacePoint> outline(const Body& body, double spacing_m) {
    std::vector<SurfacePoint> points;
    const auto parts_of = [&](double length_m) {
        return std::max(1L, std::lround(std::ceil(length_m / spacing_m)));
    };
    const Vec3 half_m = half_section_m(body);
    if (cross_section(body, Endless::along_y).is_round) {
        const double around_m = two_pi * half_m.x;
        const long parts = parts_of(around_m);
        for (long i = 0; i < parts; ++i) {
            const double angle = two_pi * static_cast<double>(i) / static_cast<double>(parts);
            const Vec3 normal{std::sin(angle), 0.0, std::cos(angle)};
            points.push_back({half_m.x * normal, normal, around_m / static_cast<double>(parts)});
        }
        return points;
    }
    for (const double sign : {-1.0, 1.0}) {
        const auto side = [&](double half_length_m, auto at) {
            const long parts = parts_of(2.0 * half_length_m);
            for (long i = 0; i < parts; ++i)
                at(half_length_m *
                       (2.0 * (static_cast<double>(i) + 0.5) / static_cast<double>(parts) - 1.0),
                   2.0 * half_length_m / static_cast<double>(parts));
        };
        side(half_m.x, [&](double x_m, double length_m) {
            points.push_back({{x_m, 0.0, sign * half_m.z}, {0.0, 0.0, sign}, length_m});
        });
        side(half_m.z, [&](double z_m, double length_m) {
            points.push_back({{sign * half_m.x, 0.0, z_m}, {sign, 0.0, 0.0}, length_m});
        });
    }
    return points;
}

SurfacePatches section_patches(const std::vector<Body>& turned_bodies,
                               const SectionMarkers& markers, double spacing_m, double base_m) {
    std::vector<PatchedBody> bodies;
    for (const Body& body : turned_bodies) {
        bodies.push_back({body.centre_m, outline(body, patch_points * spacing_m), inset_of(body)});
        std::erase_if(bodies.back().surface, [&](const SurfacePoint& p) {
            return body.centre_m.z + p.offset_m.z > base_m;
        });
    }
    std::vector<PatchedMarker> all;
    for (const SectionMarkers::Marker& m : markers.all())
        all.push_back({m.body, {m.across_m, 0.0, m.down_m}});
    return surface_patches(bodies, all, spacing_m, section_ring);
}

/// The correction around bodies across the domain. At each point along the axis it is that of
/// forces which do not vary along it: within a few spacings of the surface, the field of the load
/// hardly varies over such a distance.
class EndlessStress : public StressCorrection {
public:
    /// Not collective.
    EndlessStress(const EndlessBodies& bodies, CorrectedPlanes planes);

    void set_forces(const std::vector<double>& step_forces) override;
    void add_zz(std::size_t depth, double factor, double* plane) const override;
    std::vector<Change> changes(std::size_t depth) const override;

private:
    void put_phases();
    const double* forces_at(std::ptrdiff_t point) const;
    /// Points along the axis: all, those of this rank, and the index of the first of these.
    std::ptrdiff_t points_along() const;
    std::ptrdiff_t points() const;
    std::ptrdiff_t first_point() const;
    /// The place of a point of the section at a point along the axis.
    std::size_t place(std::size_t in_section, std::ptrdiff_t point) const;

    const EndlessBodies& bodies_;
    Domain domain_;
    fft::SlabShare share_;
    std::vector<std::vector<NearStress::Row>> rows_; // per depth
    std::vector<double> phases_;                     // of the transform along the axis
    std::vector<double> forces_; // [point along the axis][marker][across, along, down]
};

EndlessStress::EndlessStress(const EndlessBodies& bodies, CorrectedPlanes planes)
    : bodies_(bodies), domain_(planes.domain), share_(planes.share), rows_(planes.depths_m.size()) {
    const SectionMarkers& markers = bodies.markers();
    const Domain section = section_of(domain_, markers.along_x());
    std::vector<Body> all;
    for (const Body& body : bodies.endless())
        all.push_back(turned(body, markers.along_x()));
    const double lambda_per_mu = ratio_at(planes.medium, all.front().centre_m.z);
    std::vector<double> force_m;
    for (std::size_t m = 0; m < markers.all().size(); ++m)
        if (markers.depth_of(m) == force_m.size()) force_m.push_back(markers.all()[m].depth_m);
    const SectionForces of_engine(planes.mesh, domain_.spacing_m, lambda_per_mu, force_m,
                                  planes.depths_m);
    NearSolid solid{
        .bodies = {},
        .domain = section,
        .share = section_share(share_, section, markers.along_x()),
        .depths_m = std::move(planes.depths_m),
        .patches = section_patches(all, markers, domain_.spacing_m, planes.mesh.ends_m.back()),
        .marker_m = {},
        .of_engine =
            [&](std::size_t depth, std::ptrdiff_t x, std::ptrdiff_t, std::size_t marker) {
                const double period_m = section.extent_x_m();
                const double across_m =
                    static_cast<double>(x) * section.spacing_m - markers.all()[marker].at_m;
                return of_engine.at(depth, markers.depth_of(marker),
                                    across_m - period_m * std::nearbyint(across_m / period_m));
            },
        .exact = [lambda_per_mu](Vec3 r_m,
                                 Vec3 force) { return line_stress(r_m, lambda_per_mu, force); }};
    for (const Body& body : all)
        solid.bodies.push_back(
            {body, {body.centre_m - half_section_m(body), body.centre_m + half_section_m(body)}});
    for (const SectionMarkers::Marker& m : markers.all())
        solid.marker_m.push_back({section.x_m(0) + m.at_m, 0.0, m.depth_m});
    const NearStress near(std::move(solid));
    put_phases();
    for (std::size_t depth = 0; depth < rows_.size(); ++depth)
        near.each_row(depth,
                      [&](NearStress::Row&& row) { rows_[depth].push_back(std::move(row)); });
}

std::ptrdiff_t EndlessStress::points_along() const {
    return bodies_.markers().along_x() ? domain_.nx : domain_.ny;
}

std::ptrdiff_t EndlessStress::points() const {
    return bodies_.markers().along_x() ? share_.x_count : domain_.ny;
}

std::ptrdiff_t EndlessStress::first_point() const {
    return bodies_.markers().along_x() ? share_.x_start : 0;
}

std::size_t EndlessStress::place(std::size_t in_section, std::ptrdiff_t point) const {
    const auto at = static_cast<std::ptrdiff_t>(in_section);
    return static_cast<std::size_t>(bodies_.markers().along_x() ? point * share_.padded_ny + at
                                                                : at * share_.padded_ny + point);
}

/// The sum over both signs of each wavenumber, [point][wavenumber][of the real, of the imaginary
/// part].
void EndlessStress::put_phases() {
    const std::ptrdiff_t period = points_along();
    for (std::ptrdiff_t j = 0; j < points(); ++j)
        for (std::ptrdiff_t k = 0; 2 * k < period; ++k) {
            const double angle = two_pi * static_cast<double>(k * (first_point() + j) % period) /
                                 static_cast<double>(period);
            phases_.push_back((k > 0 ? 2.0 : 1.0) * std::cos(angle));
            phases_.push_back((k > 0 ? -2.0 : -1.0) * std::sin(angle));
        }
}

/// Transforms the forces along the axis. The component along it has been divided by i.
void EndlessStress::set_forces(const std::vector<double>& step_forces) {
    const std::vector<double> all = bodies_.gathered(step_forces);
    const std::ptrdiff_t waves = (points_along() + 1) / 2, // without the Nyquist wavenumber
        values = marker_components * bodies_.markers().count();
    RowMajor amplitudes(2 * waves, values);
    for (std::ptrdiff_t k = 0; k < waves; ++k)
        for (std::ptrdiff_t i = 0; i < values; ++i) {
            const double* at = all.data() + 2 * (k * values + i);
            const bool is_along = i % marker_components == along;
            // NearStress has x across the axis and y along it.
            const std::ptrdiff_t to = i % marker_components == down ? i : is_along ? i + 1 : i - 1;
            amplitudes(2 * k, to) = is_along ? -at[1] : at[0];
            amplitudes(2 * k + 1, to) = is_along ? at[0] : at[1];
        }
    forces_.resize(static_cast<std::size_t>(points() * values));
    Eigen::Map<RowMajor>(forces_.data(), points(), values).noalias() =
        Eigen::Map<const RowMajor>(phases_.data(), points(), 2 * waves) * amplitudes;
}

const double* EndlessStress::forces_at(std::ptrdiff_t point) const {
    return forces_.data() + point * marker_components * bodies_.markers().count();
}

void EndlessStress::add_zz(std::size_t depth, double factor, double* plane) const {
    for (const NearStress::Row& row : rows_[depth])
        for (std::ptrdiff_t j = 0; j < points(); ++j) {
            const double* forces = forces_at(j);
            double sum = 0.0;
            for (const auto& [marker, per_force] : row.entries)
                for (std::size_t f = 0; f < 3; ++f)
                    sum += per_force[f][zz] * forces[3 * marker + f];
            plane[place(row.place, j)] += factor * sum;
        }
}

std::vector<StressCorrection::Change> EndlessStress::changes(std::size_t depth) const {
    std::vector<Change> all;
    for (const NearStress::Row& row : rows_[depth])
        for (std::ptrdiff_t j = 0; j < points(); ++j) {
            Change change{place(row.place, j), {}};
            const double* forces = forces_at(j);
            for (const auto& [marker, per_force] : row.entries)
                for (std::size_t f = 0; f < 3; ++f)
                    for (std::size_t c = 0; c < strain_components; ++c)
                        change.stress_Pa[c] += per_force[f][c] * forces[3 * marker + f];
            if (bodies_.markers().along_x()) {
                std::swap(change.stress_Pa[xx], change.stress_Pa[yy]);
                std::swap(change.stress_Pa[yz], change.stress_Pa[xz]);
            }
            all.push_back(change);
        }
    return all;
}

} // namespace

std::unique_ptr<StressCorrection> stress_correction(const EndlessBodies* bodies,
                                                    CorrectedPlanes planes) {
    return std::make_unique<EndlessStress>(*bodies, std::move(planes));
}

double endless_stress_memory_B(const RigidPlan& plan, const DepthMesh& mesh, int ranks) {
    const Case& c = plan.c;
    std::vector<double> depths_m = stress_depths_m(c);
    if (records_tensors(c.record))
        for (const double z_m : mesh.clear_levels_m())
            depths_m.push_back(z_m);
    if (depths_m.empty()) return 0.0;
    const SectionMarkers markers(plan, mesh, WaveVectors(c.domain, {}));
    if (markers.all().empty()) return 0.0;
    const double h_m = c.domain.spacing_m, reach_m = NearStress::reach * h_m;
    double pairs = 0.0; // of points close to a body and markers next to them
    for (std::size_t i = 0; i < plan.bodies.size(); ++i) {
        const Body section = turned(plan.bodies[i], markers.along_x());
        const double half_m = half_section_m(section).x + reach_m;
        for (const double depth_m : depths_m)
            for (double x_m = -half_m; x_m < half_m; x_m += h_m) {
                const Vec3 at_m = {section.centre_m.x + x_m, 0.0, depth_m};
                if (volume_fraction(section, at_m, {}) > 0.5) continue;
                double near = 0.0, least_m = reach_m;
                for (const SectionMarkers::Marker& m : markers.all()) {
                    if (m.body != i) continue;
                    const double distance_m =
                        std::hypot(x_m - m.across_m, depth_m - section.centre_m.z - m.down_m);
                    least_m = std::min(least_m, distance_m);
                    if (distance_m < NearStress::marker_reach * h_m) near += 1.0;
                }
                if (least_m < reach_m) pairs += near;
            }
    }
    const auto count = static_cast<double>(markers.count());
    const auto nx = static_cast<double>(c.domain.nx), ny = static_cast<double>(c.domain.ny);
    const double period = markers.along_x() ? nx : ny,
                 points = markers.along_x() ? std::ceil(nx / ranks) : ny;
    const auto depths = static_cast<double>(markers.depth_of(markers.all().size() - 1) + 1);
    // Rows and phases; the response of the engine, which is released before forces and their
    // amplitudes, twice while they are taken, are allocated.
    return pairs * sizeof(NearStress::Entry) + sizeof(double) * points * period +
           std::max(SectionForces::memory_B(depths, static_cast<double>(depths_m.size())),
                    sizeof(double) * 3.0 * count * (points + 4.0 * period));
}

} // namespace shearwake::spectral
