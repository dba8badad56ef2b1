// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/view.hpp"
#include "parallel/state.hpp"
#include "problem/case/plan.hpp"

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace shearwake::engines {

/// The rows of the surface grid that this rank holds: global rows x_start to x_start + x_count - 1.
struct Slab {
    std::ptrdiff_t x_start = 0;
    std::ptrdiff_t x_count = 0;
};

/// The displacement at one output time and depth.
struct Frame {
    std::ptrdiff_t number = 0; // 0 .. TimeAxis::frames - 1, at TimeAxis::frame_s(number)
    std::size_t depth = 0;     // index into MeasureOptions::depths_m
    View2<const double> u_z_m; // x_count rows of ny values
};

/// The stress at one output time and depth, for cases that request it.
struct StressFrame {
    std::ptrdiff_t number = 0;          // number of the corresponding Frame
    std::size_t depth = 0;              // index into stress_depths_m(case)
    View2<const double> compression_Pa; // -sigma_zz, x_count rows of ny values
};

/// One tangential component of the displacement of the surface at one output time, for cases that
/// request it.
struct TangentialFrame {
    std::ptrdiff_t number = 0; // number of the corresponding Frame
    std::size_t component = 0; // 0: along x, 1: along y
    View2<const double> u_m;   // x_count rows of ny values
};

/// One depth level of one component of a volume snapshot.
struct VolumePlane {
    std::size_t snapshot = 0;   // index into RecordOptions::volumes_s
    std::size_t field = 0;      // index into RecordOptions::volume_fields
    std::size_t component = 0;  // index into components_of(the field)
    std::size_t level = 0;      // index into the levels of volume_levels()
    View2<const double> values; // x_count rows of ny values, in the field's SI unit
};

/// Energies of one period in the steady state.
struct PeriodEnergy {
    double work_J = 0.0;               // of the load
    double absorbed_in_layers_J = 0.0; // by viscosity, in layers of finite thickness
    double radiated_J = 0.0;           // into the half-space below them
    /// The difference of work and losses, relative to the work; 0 for a load that does no work.
    double imbalance() const {
        const double difference_J = work_J - absorbed_in_layers_J - radiated_J;
        return difference_J == 0.0 ? 0.0 : difference_J / work_J;
    }
};

/// Effort of a case, and the engine's choices with their reasons. Identical on all ranks.
struct SolverReport {
    std::vector<std::string> notes;     // one line per choice
    std::ptrdiff_t steps = 0;           // 0 for an engine without time stepping
    std::ptrdiff_t iterations = 0;      // total number of iterations of the linear solver
    std::ptrdiff_t most_iterations = 0; // maximum number of iterations in one step
    // Work of the load, and the kinetic and elastic energy half a step before the end.
    double work_J = 0.0, energy_J = 0.0;
    std::optional<PeriodEnergy> period_energy = std::nullopt; // in the periodic regime
    std::vector<Remark> warnings = {}; // those of the notes that reduce the accuracy
};

/// Receives the field of a case while the engine computes it. Called on every rank of the team in
/// the same order, including ranks with an empty slab. An observer must not throw on one rank only.
/// Nothing has an empty default, so that an observer cannot miss a part of the field unnoticed.
class Observer {
public:
    virtual ~Observer() = default;
    virtual void begin(const Slab& slab) = 0;
    virtual void frame(const Frame& frame) = 0;
    /// The stress at the depths of receptors, after the frame of the same time. Only for cases that
    /// request it.
    virtual void stress(const StressFrame& frame) = 0;
    /// The tangential displacement, after all frames. Only for cases that request it.
    virtual void tangential(const TangentialFrame& frame) = 0;
    /// The depths of the levels of volumes. Called once, after `begin` and before `restore`, for
    /// cases that record volumes. Collective.
    virtual void volume_levels(const std::vector<double>& z_m) = 0;
    /// One plane of a snapshot, in any order, before the next frame. Collective.
    virtual void volume(const VolumePlane& plane) = 0;
    /// Called once after the last frame by engines that provide a report. Collective.
    virtual void solved(const SolverReport& report) = 0;
    /// Save and restore what the observer has accumulated, as a part of the engine's checkpoints.
    /// `restore` follows `begin`. Collective.
    virtual void save(StateWriter& state) = 0;
    virtual void restore(const StateReader& state) = 0;
};

} // namespace shearwake::engines
