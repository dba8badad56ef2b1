// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/lump_bodies.hpp"
#include "support/displacement_at.hpp"
#include "support/growing_motion.hpp"
#include "support/spectral_cases.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

namespace shearwake::test {

/// The forces at the markers of a rigid sphere in the middle of a large domain at exponential
/// growth, and their field.
class RigidSphere {
public:
    using Marker = spectral::LumpBodies::Marker;

    /// kappa = s radius/c_s for growth e^{st}, 0 for a static field; `width` is that of the domain
    /// in radii.
    RigidSphere(double spacings_per_radius, double kappa, double width,
                double lambda_per_mu = incompressible) {
        const double spacing_m = body_radius_m / spacings_per_radius;
        const auto n = 2 * std::lround(0.5 * width * spacings_per_radius);
        const SpectralOptions options{.time_step_s = 1e-3,
                                      .longest_element_m = 2.0 * body_radius_m};
        case_ = solid_around({.name = "sphere",
                              .shape = Ellipsoid{{body_radius_m, body_radius_m, body_radius_m}},
                              .centre_m = {0.2 * spacing_m, 0.3 * spacing_m, 0.0},
                              .rigid = true,
                              .fixed = true},
                             width, {n, n, spacing_m, 0.0}, options);
        const Comm alone = Comm::world().split(Comm::world().rank());
        slabs_.emplace(n, n, alone);
        vectors_.emplace(case_.domain, slabs_->share());
        mesh_ = spectral::choose_mesh(case_, options, 1e-3);
        operator_.emplace(mesh_,
                          growing_background(mesh_, case_.scene.medium, kappa, lambda_per_mu));
        const std::ptrdiff_t size = operator_->factor_size();
        factors_.resize(static_cast<std::size_t>(vectors_->pencils() * size));
        for (std::ptrdiff_t row = 0; row < vectors_->rows(); ++row)
            for (std::ptrdiff_t block = 0; block < vectors_->blocks(); ++block)
                operator_->factorise_implicit(vectors_->waves(row, block).k, 1.0,
                                              factors_.data() +
                                                  (row * vectors_->blocks() + block) * size);
        bodies_.emplace(case_, mesh_, *slabs_, *vectors_, 1.0, alone);
        bodies_->assemble(*operator_, [&](std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) {
            solve(row, block, pencil);
        });
    }

    const std::vector<Marker>& markers() const { return bodies_->markers(); }

    /// The forces [N], (x, y, z) at all markers, for a displacement of the markers [m].
    std::vector<double> forces(const std::vector<double>& displacement) const {
        return bodies_->forces(displacement);
    }
    /// A displacement, given as a function of the offset from the centre, at all markers.
    template <class Displacement>
    std::vector<double> at_markers(const Displacement& displacement) const {
        std::vector<double> all;
        for (const Marker& m : markers()) {
            const Vec3 u = displacement(m.offset_m);
            all.insert(all.end(), {u.x, u.y, u.z});
        }
        return all;
    }
    /// The same as the markers evaluate it: smoothed laterally by their kernels.
    template <class Displacement>
    std::vector<double> smoothed_at_markers(const Displacement& displacement) const {
        std::vector<double> all;
        for (const Marker& m : markers()) {
            Vec3 u{};
            for (std::size_t i = 0; i < spectral::kernel_points; ++i)
                for (std::size_t j = 0; j < spectral::kernel_points; ++j) {
                    const Domain& d = case_.domain;
                    const Vec3 point{d.x_m(m.x + static_cast<std::ptrdiff_t>(i) - 1) - centre().x,
                                     d.y_m(m.y + static_cast<std::ptrdiff_t>(j) - 1) - centre().y,
                                     m.offset_m.z};
                    u = u + (m.along_x[i] * m.along_y[j]) * displacement(point);
                }
            all.insert(all.end(), {u.x, u.y, u.z});
        }
        return all;
    }
    /// Work of the forces of a motion on this motion, in units of mu a.
    template <class Displacement>
    double stiffness(const Displacement& displacement) const {
        const std::vector<double> motion = at_markers(displacement);
        return work(forces(motion), motion);
    }
    static double work(const std::vector<double>& force, const std::vector<double>& motion) {
        double sum = 0.0;
        for (std::size_t i = 0; i < force.size(); ++i)
            sum += force[i] * motion[i];
        return sum / (solid_mu_Pa * body_radius_m);
    }
    /// The displacement [m] of the solid at offsets from the centre due to forces at the markers.
    std::vector<Vec3> field(const std::vector<double>& forces, const std::vector<Vec3>& offsets) {
        const fft::AlignedVector<Block> all = displacement(forces);
        std::vector<Vec3> displacements;
        for (const Vec3& offset : offsets)
            displacements.push_back(displacement_at(case_.domain, mesh_, *vectors_, all.data(),
                                                    centre() + offset,
                                                    [](double, double) { return 1.0; }));
        return displacements;
    }

private:
    /// The pencils of the displacement due to forces at the markers.
    fft::AlignedVector<Block> displacement(const std::vector<double>& forces) {
        bodies_->exert(forces);
        const std::ptrdiff_t size = operator_->unknowns() * spectral::parts;
        fft::AlignedVector<Block> all(static_cast<std::size_t>(vectors_->pencils() * size));
        for (std::ptrdiff_t row = 0; row < vectors_->rows(); ++row) {
            bodies_->begin_forces(row);
            for (std::ptrdiff_t block = 0; block < vectors_->blocks() && !vectors_->is_nyquist(row);
                 ++block) {
                Block* pencil = all.data() + (row * vectors_->blocks() + block) * size;
                bodies_->add_force(row, block, pencil);
                solve(row, block, pencil);
            }
        }
        return all;
    }
    Vec3 centre() const { return case_.scene.medium.bodies[0].centre_m; }
    void solve(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) const {
        operator_->solve_implicit(factors_.data() +
                                      (row * vectors_->blocks() + block) * operator_->factor_size(),
                                  pencil);
    }

    Case case_;
    std::optional<fft::SlabTransform> slabs_;
    std::optional<spectral::WaveVectors> vectors_;
    spectral::DepthMesh mesh_;
    std::optional<spectral::VerticalOperator> operator_;
    fft::AlignedVector<Block> factors_;
    std::optional<spectral::LumpBodies> bodies_;
};

/// Force per displacement, radius and mu on a rigid sphere full of background: Stokes (1851) and
/// its mass. The same for the torque over radius^2. x = s radius/c_s, real or complex.
template <class X>
X force_on_sphere(X x) {
    return 6.0 * std::numbers::pi * (1.0 + x + x * x / 9.0) + 4.0 * std::numbers::pi / 3.0 * x * x;
}
template <class X>
X torque_on_sphere(X x) {
    return 8.0 * std::numbers::pi * (1.0 + x + x * x / 3.0) / (1.0 + x) +
           8.0 * std::numbers::pi / 15.0 * x * x;
}

/// Force per displacement, radius and mu that the shear wave e^{x z/a}, polarised across z, exerts
/// on a rigid sphere at rest (Mazur and Bedeaux, Physica 76, 1974): 1 + x times the mean of the
/// wave over the surface and x^2/3 times its mean over the volume.
template <class X>
X force_in_wave(X x) {
    return 6.0 * std::numbers::pi *
           ((1.0 + x) * std::sinh(x) / x + (x * std::cosh(x) - std::sinh(x)) / x);
}
/// The same for the torque over radius^2 of a wave along z, polarised along x, about y: the
/// parts of torque_on_sphere() times the means of z times the wave over the surface and over the
/// volume, in units of those of (z^2 + x^2).
template <class X>
X torque_in_wave(X x) {
    const X surface = 1.5 * (x * std::cosh(x) - std::sinh(x)) / (x * x);
    const X volume = 7.5 * (x * x * std::sinh(x) - 3.0 * x * std::cosh(x) + 3.0 * std::sinh(x)) /
                     (x * x * x * x);
    return 8.0 * std::numbers::pi * (1.0 + x + x * x / 3.0) / (1.0 + x) * surface +
           8.0 * std::numbers::pi / 15.0 * x * x * volume;
}

} // namespace shearwake::test
