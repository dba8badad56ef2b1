// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/lump_bodies.hpp"
#include "engines/spectral/bodies/stress/near_stress.hpp"

namespace shearwake::spectral {

/// The correction around lumps.
class LumpStress : public StressCorrection {
public:
    /// add_zz() is available for Corrected::zz, and changes() for all components. Not collective.
    LumpStress(const LumpBodies& lumps, const Medium& medium, const Domain& domain,
               const DepthMesh& mesh, const fft::SlabShare& share, std::vector<double> depths_m,
               Corrected use);

    void take(const std::vector<double>& step_forces) override { forces_ = step_forces; }
    void add_zz(std::size_t depth, double factor, double* plane) const override;
    std::vector<Change> changes(std::size_t depth) const override {
        return near_.changes(depth, forces_);
    }

private:
    struct Entry {
        std::size_t marker;
        std::array<double, 3> weights;
    };
    struct Row {
        std::size_t place;
        std::vector<Entry> entries;
    };
    GridForces grid_;
    NearStress near_;
    std::vector<std::vector<Row>> rows_; // per depth: the matrix of sigma_zz
    std::vector<double> forces_;         // [marker][x, y, z]
};

/// Memory of the corrections of a case on the rank that needs most, in bytes. Not collective.
double lump_stress_memory_B(const Case& c, const DepthMesh& mesh, int ranks);

} // namespace shearwake::spectral
