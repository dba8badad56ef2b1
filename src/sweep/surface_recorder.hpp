#pragma once

#include "engines/engine.hpp"
#include "io/case_file_writer.hpp"
#include "measures/summary.hpp"
#include "model/case.hpp"

#include <functional>
#include <optional>
#include <vector>

namespace shearwake {

/// The observer of every case: measures each frame on this rank's slab, keeps traces, passes on the
/// frames and volumes to be kept, holds the surface at the instant `measure.at` for the wake's
/// angle, and averages its energy over the period window.
class SurfaceRecorder : public Observer {
public:
    /// `writer` may be null (nothing is kept). `tick` is called once a frame, for the progress
    /// line.
    SurfaceRecorder(const Case& c, const Comm& team, CaseFileWriter* writer,
                    std::function<void()> tick);

    void begin(const Slab& slab) override;
    void frame(const Frame& frame) override;
    void stress(const StressFrame& frame) override;
    void volume_levels(const std::vector<double>& z_m) override;
    void volume(const VolumePlane& plane) override;
    void solved(const SolverReport& report) override { solver_ = report; }
    /// Every rank's own part of the sums: the same ranks go on bit for bit, others share the parts
    /// out. The frames kept so far reach the disk.
    void save(StateWriter& state) override;
    void restore(StateReader& state) override;

    /// Where the stress is kept that the engine gives: places and, for each, its depth's index.
    /// Before the run.
    void keep_stress(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths);
    /// The stress there [Pa], compression positive, at every frame; 0 off the domain.
    const std::vector<TraceSeries>& stresses_Pa() const { return stresses_; }

    /// Collective, once, after the engine: combines the slabs. Throws CaseFailure when the field is
    /// not finite or a volume is not whole.
    void finish();

    const std::vector<DepthSeries>& depths() const { return depths_; }
    const std::vector<TraceSeries>& traces() const { return traces_; }
    /// The same at the pins of the case's afferents.
    const std::vector<TraceSeries>& pins() const { return pins_; }
    /// On rank 0 only; empty elsewhere.
    const std::optional<MachFit>& mach() const { return mach_; }
    /// Time mean of u_z^2 over the period window, of the first depth [m^2], (x, y) row-major. On
    /// rank 0 only; empty elsewhere, and when no window fits.
    const std::vector<double>& mean_u2() const { return mean_u2_; }
    /// What the engine has told; empty if it had nothing to tell.
    const SolverReport& solver() const { return solver_; }

    /// The frames that a case keeps: all, or those nearest to the wanted snapshots.
    static std::vector<std::ptrdiff_t> kept_frames(const Case& c);

private:
    StateRows surface_rows() const {
        return {case_.domain.nx, slab_.x_start, slab_.x_count, case_.domain.ny};
    }
    void add_to_mean(const Frame& frame);
    double value_at(Vec2 at_m, View2<const double> values) const;
    void check_volumes() const;
    void fit_mach(const std::vector<double>& instant);

    const Case& case_;
    const Comm& team_;
    CaseFileWriter* writer_;
    std::function<void()> tick_;
    Slab slab_;
    Region region_;
    std::ptrdiff_t instant_ = 0;
    std::vector<std::ptrdiff_t> kept_;
    std::vector<double> mean_weights_; // of each frame, 1 in all; empty: no window fits
    std::vector<DepthSeries> depths_;
    std::vector<TraceSeries> traces_, pins_, stresses_;
    std::vector<std::size_t> stress_depths_; // of each of the latter
    std::vector<double> mean_rows_;          // of this rank, so far
    std::vector<double> mean_u2_;
    std::vector<double> instant_rows_;
    bool instant_held_ =
        false; // the frame of the instant has come; this rank may have no row of it
    double volume_planes_ = 0.0; // so far
    std::optional<MachFit> mach_;
    SolverReport solver_;
};

} // namespace shearwake
