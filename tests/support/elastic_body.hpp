// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/lateral/strain_planes.hpp"
#include "engines/spectral/lateral/strain_solver.hpp"
#include "support/growing_motion.hpp"
#include "support/spectral_cases.hpp"

#include <cmath>
#include <functional>
#include <optional>
#include <vector>

namespace shearwake::test {

/// An elastic body in the middle of a large domain that a wave meets, at exponential growth: the
/// cells of the engine without its time steps. The field is incident + scattered, where
///     (B + E^T S E) scattered = -E^T (S - S_solid) E incident
/// with the operator B of the background, the strain E and the stiffness S in excess of B.
class ElasticBody {
public:
    /// In units of the radius. A span of 0: the domain is four points wide, along an endless body.
    struct Span {
        double x = 16.0, y = 16.0, depth = 16.0;
    };
    using Values = spectral::LateralField::Values;
    using Motion = std::function<Vec3(Vec3)>; // of an offset from the centre in radii

    /// kappa = s radius/c_s for growth e^{st}; the body is centred apart from (x, y) in spacings.
    ElasticBody(Body body, double spacings_per_radius, double kappa, Span span,
                Vec3 offset = {0.2, 0.3, 0.0}) {
        const double spacing_m = body_radius_m / spacings_per_radius;
        const auto points = [&](double width) {
            return std::max(4L, 2 * std::lround(0.5 * width * spacings_per_radius));
        };
        SpectralOptions options{.time_step_s = 1e-3};
        options.method = SpectralMethod::iterative;
        options.contrast_cap = options.rigid_above = 1e9;
        body.centre_m = spacing_m * offset;
        case_ = solid_around(std::move(body), span.depth,
                             {points(span.x), points(span.y), spacing_m, 0.0}, options);
        Vec3& centre_m = case_.scene.medium.bodies[0].centre_m;
        centre_m.z += spacing_m * offset.z;
        centre_m_ = centre_m;
        mesh_ = spectral::choose_mesh(case_, options, 1e-3);
        slabs_.emplace(case_.domain.nx, case_.domain.ny, alone_);
        vectors_.emplace(case_.domain, slabs_->share());

        const double growth_1_s = kappa / body_radius_m * std::sqrt(solid_mu_Pa / solid_kg_m3);
        constexpr double step_s = 1e-9; // nothing is stabilised
        auto v =
            spectral::lateral_variation(case_, mesh_, slabs_->share(),
                                        spectral::largest_k_rad_m(case_.domain), step_s, &alone_);
        spectral::Background b = v.background;
        // The weights of the implicit operator are .26 and 1/12.
        for (std::size_t i = 0; i < b.density_kg_m3.size(); ++i) {
            excess_mu_Pa_.push_back(solid_mu_Pa - b.mu_accurate_Pa[i]);
            b.density_kg_m3[i] *= growth_1_s * growth_1_s;
            b.lambda_Pa[i] = incompressible * solid_mu_Pa / 0.26;
            b.mu_accurate_Pa[i] *= 12.0;
            b.mu_stable_Pa[i] = b.viscosity_Pa_s[i] = 0.0;
        }
        operator_.emplace(mesh_, b);
        for (std::size_t i = 0; i < v.cells; ++i) {
            v.implicit_mu[i] = v.mu[i] + growth_1_s * v.viscosity[i];
            v.implicit_lambda[i] = 0.0;
        }
        for (auto& surfaces : v.surfaces)
            for (auto& surface : surfaces)
                surface.implicit_mu = surface.mu + growth_1_s * surface.viscosity;
        for (double& mass : v.implicit_mass)
            mass *= std::pow(step_s * growth_1_s, 2);
        field_.emplace(std::move(v), case_.domain.ny, slabs_->share());
        planes_.emplace(field_->cells(), *slabs_, alone_, spectral::StrainPlanes::Corner{});
        planes_->assemble();
        transfer_.emplace(mesh_, field_->variation().strain_points,
                          field_->variation().components());
        const std::ptrdiff_t size = operator_->factor_size();
        factors_.resize(static_cast<std::size_t>(vectors_->pencils() * size));
        for (std::ptrdiff_t row = 0; row < vectors_->rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors_->blocks(); ++block)
                operator_->factorise_implicit(vectors_->waves(row, block).k, 1.0,
                                              factors_.data() +
                                                  (row * vectors_->blocks() + block) * size);
    }

    /// The work of the forces that the body adds to the solid in this wave, with a negative sign,
    /// on a motion of the solid that is possible without the body, in units of mu radius^3 for
    /// motions in units of the radius (for endless bodies: per length of a radius). Only cells for
    /// which `counts` is true contribute to it.
    double work(
        const Motion& incident, const Motion& probe,
        const std::function<bool(Vec3)>& counts = [](Vec3) { return true; }) {
        const Values wave = strain(incident);
        Values source = excess(wave), residual(wave.size());
        respond(source, residual);
        spectral::StrainSolver solver(*field_, case_.domain.nx, alone_);
        double scale = 0.0;
        Values stress(wave.size());
        for (std::size_t p = 0; p < field_->points(); ++p)
            field_->implicit(p, residual, stress);
        for (std::size_t i = 0; i < stress.size(); ++i)
            scale += stress[i] * residual[i];
        const auto outcome = solver.solve(
            residual, scale, 1e-6,
            {.full = [this](const Values& a, Values& b) { respond(a, b); }, .rounded = {}});
        iterations_ = outcome.iterations;
        if (!outcome.converged) return std::nan("");
        Values all = wave;
        for (std::size_t i = 0; i < all.size(); ++i)
            all[i] += solver.strain()[i];
        const Values added = excess(all), of_probe = strain(probe);
        double sum = 0.0;
        each_cell([&](Vec3 at, std::size_t first, std::size_t stride) {
            if (!counts(at)) return;
            for (int c = 0; c < field_->variation().components(); ++c) {
                const std::size_t i = first + static_cast<std::size_t>(c) * stride;
                sum += added[i] * of_probe[i];
            }
        });
        // The quadrature weights contain the depth.
        const double area_m2 = case_.domain.spacing_m * case_.domain.spacing_m;
        double length = 1.0;
        if (case_.domain.nx == 4) length = case_.domain.extent_x_m() / body_radius_m;
        if (case_.domain.ny == 4) length = case_.domain.extent_y_m() / body_radius_m;
        return sum * area_m2 / (solid_mu_Pa * std::pow(body_radius_m, 3) * length);
    }
    int iterations() const { return iterations_; }

private:
    void each_cell(const auto& use) const {
        const auto& v = field_->variation();
        const auto components = static_cast<std::size_t>(v.components());
        for (std::size_t p = 0; p < v.points.size(); ++p) {
            const spectral::StrainPoint& where = v.strain_points[p];
            const double z_m = mesh_.z_m(where.element * static_cast<std::size_t>(mesh_.degree) +
                                         static_cast<std::size_t>(where.node));
            for (const fft::RowRun& run : v.points[p].runs)
                for (std::ptrdiff_t j = run.begin; j < run.end; ++j) {
                    const Vec3 at{case_.domain.x_m(run.row), case_.domain.y_m(j), z_m};
                    use((1.0 / body_radius_m) * (at - centre_m_),
                        v.points[p].first * components + run.offset +
                            static_cast<std::size_t>(j - run.begin),
                        v.points[p].cells);
                }
        }
    }
    /// Engineering strain of a motion in units of the radius, and the motion where the density
    /// varies [m].
    Values strain(const Motion& motion) const {
        Values all(field_->size());
        constexpr double h = 1e-4; // error h^2
        each_cell([&](Vec3 at, std::size_t first, std::size_t stride) {
            const auto slope = [&](Vec3 step) {
                return (0.5 / h) * (motion(at + step) - motion(at - step));
            };
            const Vec3 x = slope({h, 0, 0}), y = slope({0, h, 0}), z = slope({0, 0, h});
            const double e[] = {x.x, y.y, z.z, y.z + z.y, x.z + z.x, x.y + y.x};
            for (std::size_t c = 0; c < 6; ++c)
                all[first + c * stride] = e[c];
            if (field_->variation().components() == 6) return;
            const Vec3 u = body_radius_m * motion(at);
            all[first + 6 * stride] = u.x;
            all[first + 7 * stride] = u.y;
            all[first + 8 * stride] = u.z;
        });
        return all;
    }
    /// Stress in excess of that of the solid.
    Values excess(const Values& of_strain) const {
        Values all(of_strain.size());
        const auto& v = field_->variation();
        for (std::size_t p = 0; p < field_->points(); ++p) {
            field_->implicit(p, of_strain, all);
            const spectral::StrainPoint& where = v.strain_points[p];
            const auto node = static_cast<std::size_t>(where.node);
            const double solid =
                0.5 * mesh_.length_m(where.element) * mesh_.rule.weights[node] *
                excess_mu_Pa_[where.element * static_cast<std::size_t>(mesh_.degree + 1) + node];
            const std::size_t begin = field_->range(p).first, n = v.points[p].cells;
            for (std::size_t c = 0; c < 6; ++c)
                for (std::size_t i = 0; i < n; ++i)
                    all[begin + c * n + i] -=
                        (c < 3 ? 2.0 : 1.0) * solid * of_strain[begin + c * n + i];
        }
        return all;
    }
    /// Strain due to minus a stress.
    void respond(const Values& stress, Values& strain) {
        fft::AlignedVector<Block> force(static_cast<std::size_t>(operator_->unknowns()) *
                                        spectral::parts);
        const double per_point = 1.0 / static_cast<double>(case_.domain.nx * case_.domain.ny);
        planes_->set(stress);
        for (std::ptrdiff_t row = 0; row < vectors_->rows(); ++row) {
            const bool is_nyquist = vectors_->is_nyquist(row);
            planes_->begin_row(row);
            for (std::ptrdiff_t block = 0; block < vectors_->blocks() && !is_nyquist; ++block) {
                const auto waves = planes_->in_line(vectors_->waves(row, block));
                std::fill(force.begin(), force.end(), Block{});
                transfer_->add_force(waves, planes_->line(row), planes_->stride(), per_point,
                                     force.data());
                operator_->solve_implicit(factors_.data() + (row * vectors_->blocks() + block) *
                                                                operator_->factor_size(),
                                          force.data());
                transfer_->strain(waves, force.data(), planes_->line(row), planes_->stride());
            }
            planes_->end_row(row, is_nyquist ? spectral::StrainPlanes::Modes::emptied
                                             : spectral::StrainPlanes::Modes::retained);
        }
        planes_->get(strain);
    }

    Case case_;
    Vec3 centre_m_;
    Comm alone_ = Comm::world().split(Comm::world().rank());
    std::optional<fft::SlabTransform> slabs_;
    std::optional<spectral::WaveVectors> vectors_;
    spectral::DepthMesh mesh_;
    std::vector<double> excess_mu_Pa_;
    std::optional<spectral::VerticalOperator> operator_;
    std::optional<spectral::LateralField> field_;
    std::optional<spectral::StrainPlanes> planes_;
    std::optional<spectral::StrainTransfer> transfer_;
    fft::AlignedVector<Block> factors_;
    int iterations_ = 0;
};

} // namespace shearwake::test
