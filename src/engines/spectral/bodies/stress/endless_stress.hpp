// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_bodies.hpp"
#include "engines/spectral/bodies/stress/grid_forces.hpp"
#include "engines/spectral/bodies/stress/near_stress.hpp"

namespace shearwake::spectral {

/// The correction around bodies across the domain. At each point along the axis it is that of
/// forces which do not vary along it: within a few spacings of the surface, the field of the load
/// hardly varies over such a distance.
class EndlessStress : public StressCorrection {
public:
    /// Not collective.
    EndlessStress(const EndlessBodies& bodies, const Medium& medium, const Domain& domain,
                  const DepthMesh& mesh, const fft::SlabShare& share, std::vector<double> depths_m);

    void take(const std::vector<double>& step_forces) override;
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

/// Memory of the corrections of a case on each rank, in bytes. Not collective.
double endless_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
