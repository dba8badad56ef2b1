// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/observers/recording.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace shearwake::pipeline {

/// Receivers of parts of a case while it is computed; none is required.
struct Sinks {
    engines::Checkpoints* checkpoints = nullptr; // see engines::FrameSource::run
    storage::CaseFileWriter* writer = nullptr;   // of the fields that the case stores
    std::function<void()> tick = {};             // called once per frame, for the progress line
    /// The surface at all frames in single precision, on rank 0 with the shape [frame][x][y]. Not a
    /// part of checkpoints.
    std::vector<float>* frames = nullptr;
};

/// The observer of all cases. Each of its parts records one kind of data.
class SurfaceRecorder : public engines::Observer {
public:
    SurfaceRecorder(const Case& c, const Comm& team, const Sinks& sinks);
    SurfaceRecorder(const SurfaceRecorder&) = delete; // there are pointers to its parts
    SurfaceRecorder& operator=(const SurfaceRecorder&) = delete;

    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void stress(const engines::StressFrame& frame) override;
    void tangential(const engines::TangentialFrame& frame) override;
    void volume_levels(const std::vector<double>& z_m) override;
    void volume(const engines::VolumePlane& plane) override;
    void solved(const engines::SolverReport& report) override { solver_ = report; }
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;

    /// Sets where the stress is recorded: positions and, for each, the index of its depth. Call
    /// before the run.
    void record_stress(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths) {
        stresses_.record_at(at_m, std::move(depths));
    }

    /// Collective, once, after the engine: combines the slabs. Throws CaseFailure when the field is
    /// not finite or a volume is not complete.
    void finish();

    const std::vector<measures::DepthSeries>& depths() const { return sums_.depths(); }
    const std::vector<measures::TraceSeries>& traces() const { return traces_.series(); }
    /// u_z at the pins of the afferents of the case.
    const std::vector<measures::TraceSeries>& pins() const { return pins_.series(); }
    /// The stress at the receptors [Pa], compression positive, at every frame; 0 off the domain.
    const std::vector<measures::TraceSeries>& stresses_Pa() const { return stresses_.series(); }
    /// The displacement along the line of sight of the vibrometer, see ScanSeries.
    const std::vector<double>& scan_m() const { return scan_.displacements_m(); }
    /// On rank 0 only; empty elsewhere.
    const std::optional<measures::MachFit>& mach() const { return instant_.mach(); }
    /// Time mean of u_z^2 over the period window, of the first depth [m^2], (x, y) row-major. On
    /// rank 0 only; empty elsewhere, and when no window fits.
    const std::vector<double>& mean_u2() const { return mean_.values(); }
    /// The level of sensation. On rank 0 only; empty elsewhere, and where it is not computed.
    const measures::SensationMap& sensation() const { return sensation_.map(); }
    /// The notes of the engine; empty if there are none.
    const engines::SolverReport& solver() const { return solver_; }

private:
    const Comm& team_;
    std::function<void()> tick_;
    FrameSums sums_;
    PointSeries traces_, pins_;
    ReceptorSeries stresses_;
    ScanSeries scan_;
    MeanEnergy mean_;
    InstantSurface instant_;
    SensationLevels sensation_;
    std::optional<StoredFields> stored_;
    std::optional<SurfaceFrames> frames_;
    std::vector<Recording*> parts_; // all of these
    engines::SolverReport solver_;
};

} // namespace shearwake::pipeline
