// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_bodies.hpp"
#include "engines/spectral/bodies/section_markers.hpp"
#include "engines/spectral/stepping/receptor_stress.hpp"
#include "simd/kernels.hpp"
#include "support/growing_motion.hpp"
#include "support/spectral_cases.hpp"
#include "support/stress_store.hpp"

#include <Eigen/Dense>
#include <cmath>
#include <optional>
#include <vector>

namespace shearwake::test {

inline double bessel_i(int n, double x) {
    return std::cyl_bessel_i(static_cast<double>(n), x);
}
inline double bessel_k(int n, double x) {
    return std::cyl_bessel_k(static_cast<double>(n), x);
}

/// The forces at the markers of a cylinder along y in the middle of a large domain, for motion
/// that is constant along the axis, and their field.
class RigidCylinder {
public:
    /// kappa = s radius/c_s for growth e^{st}; `width` is that of the domain in radii.
    RigidCylinder(double spacings_per_radius, double kappa, double width = 20.0,
                  double lambda_per_mu = incompressible) {
        const double spacing_m = body_radius_m / spacings_per_radius;
        const auto nx = 2 * std::lround(0.5 * width * spacings_per_radius);
        const SpectralOptions options{.time_step_s = 1e-3,
                                      .longest_element_m = 2.0 * body_radius_m};
        case_ = solid_around({.name = "cylinder",
                              .shape = Cylinder{.radius_m = body_radius_m, .azimuth_deg = 90.0},
                              .centre_m = {0.2 * spacing_m, 0.0, 0.0},
                              .rigid = true},
                             width, {nx, 4, spacing_m, 0.0}, options);
        slabs_.emplace(nx, 4, alone_);
        vectors_.emplace(case_.domain, slabs_->share());
        mesh_ = spectral::choose_mesh(case_, options, 1e-3);
        operator_.emplace(mesh_,
                          growing_background(mesh_, case_.scene.medium, kappa, lambda_per_mu));
        markers_.emplace(case_, mesh_, *vectors_);
        spectral::EndlessSystems systems(*markers_, *vectors_, alone_);
        systems.assemble(*operator_, [&](std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) {
            solve(row, block, pencil);
        });
        const auto n = static_cast<Eigen::Index>(systems.unknowns());
        inverse_ = Eigen::Map<const Eigen::MatrixXd>(systems.inverse(0), n, n);
    }

    const std::vector<spectral::SectionMarkers::Marker>& markers() const {
        return markers_->markers();
    }

    /// The forces per length [N/m] for a displacement (along, across, down) of the markers [m].
    template <class Displacement>
    Eigen::VectorXd forces(const Displacement& displacement) const {
        return inverse_ * values(displacement);
    }
    /// The same vector of (along, across, down) at all markers.
    template <class Displacement>
    Eigen::VectorXd values(const Displacement& displacement) const {
        Eigen::VectorXd all(inverse_.rows());
        for (std::size_t i = 0; i < markers().size(); ++i) {
            const Vec3 u = displacement(markers()[i].across_m, markers()[i].down_m);
            const auto at = static_cast<Eigen::Index>(3 * i);
            all[at] = u.x, all[at + 1] = u.y, all[at + 2] = u.z;
        }
        return all;
    }
    /// Work of the forces of a motion on this motion, in units of mu.
    template <class Displacement>
    double stiffness(const Displacement& displacement) const {
        const Eigen::VectorXd motion = values(displacement);
        return motion.dot(inverse_ * motion) / solid_mu_Pa;
    }

    /// sigma_zz [Pa] due to forces across and down, as receptors receive it, at points relative to
    /// the axis.
    struct Stress {
        double across_m, down_m, sigma_zz_Pa;
    };
    std::vector<Stress> stress(const Eigen::VectorXd& forces, const std::vector<double>& downs_m) {
        std::vector<double> depths_m;
        for (const double down_m : downs_m)
            depths_m.push_back(centre().z + down_m);
        spectral::ReceptorStress receptors(case_, depths_m, mesh_, *slabs_, 1.0, alone_);
        const fft::AlignedVector<Block> u = displacement(forces);
        StressStore store;
        store.begin({.x_start = 0, .x_count = case_.domain.nx});
        receptors.remember(u.data());
        receptors.emit({u.data(), u.data()}, 0, store);
        std::vector<Stress> all;
        for (std::size_t n = 0; n < downs_m.size(); ++n)
            for (std::ptrdiff_t i = 0; i < case_.domain.nx; ++i)
                all.push_back({case_.domain.x_m(i) - centre().x, downs_m[n],
                               -store.at(0, n)[static_cast<std::size_t>(i * case_.domain.ny)]});
        return all;
    }
    double width_m() const { return case_.domain.extent_x_m(); }
    double spacing_m() const { return case_.domain.spacing_m; }

private:
    /// The pencils of the displacement due to forces at the markers.
    fft::AlignedVector<Block> displacement(const Eigen::VectorXd& forces) const {
        using spectral::marker_components;
        fft::AlignedVector<Block> of_markers(
            static_cast<std::size_t>(markers_->count() * spectral::marker_parts), Block{});
        for (Eigen::Index i = 0; i < forces.size(); ++i)
            if (i % marker_components != spectral::along) // the real part
                of_markers[static_cast<std::size_t>(2 * i)] = block_of(forces[i]);
        const std::ptrdiff_t size = operator_->unknowns() * spectral::parts;
        fft::AlignedVector<Block> all(static_cast<std::size_t>(vectors_->pencils() * size),
                                      Block{});
        for (std::ptrdiff_t block = 0; block < vectors_->blocks(); ++block) {
            Block* pencil = all.data() + block * size; // of row 0
            simd::kernels<spectral::MarkerKernels>().add_force(
                markers_->arrays(), vectors_->waves(0, block), of_markers.data(),
                markers_->phases(0, block), 1.0 / markers_->across_extent_m(), pencil);
            solve(0, block, pencil);
        }
        return all;
    }
    void solve(std::ptrdiff_t row, std::ptrdiff_t block, Block* pencil) const {
        fft::AlignedVector<Block> factor(static_cast<std::size_t>(operator_->factor_size()));
        operator_->factorise_implicit(vectors_->waves(row, block).k, 1.0, factor.data());
        operator_->solve_implicit(factor.data(), pencil);
    }
    Vec3 centre() const { return case_.scene.medium.bodies[0].centre_m; }

    Case case_;
    Comm alone_ = Comm::world().split(Comm::world().rank());
    std::optional<fft::SlabTransform> slabs_;
    std::optional<spectral::WaveVectors> vectors_;
    spectral::DepthMesh mesh_;
    std::optional<spectral::VerticalOperator> operator_;
    std::optional<spectral::SectionMarkers> markers_;
    Eigen::MatrixXd inverse_;
};

} // namespace shearwake::test
