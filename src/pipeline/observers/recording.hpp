// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "measures/spatial_measures.hpp"
#include "measures/sensation.hpp"
#include "measures/summary.hpp"
#include "parallel/agree.hpp"
#include "storage/case_file/case_file_writer.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::pipeline {

/// Base of the parts of SurfaceRecorder, each of which records one kind of data and ignores the
/// others: it receives the field, is saved to and restored from checkpoints, and combines the slabs
/// at the end.
class Recording : public engines::Observer {
public:
    Recording(const Case& c, const Comm& team) : case_(c), team_(team) {}
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void frame(const engines::Frame&) override {}
    void stress(const engines::StressFrame&) override {}
    void tangential(const engines::TangentialFrame&) override {}
    void volume_levels(const std::vector<double>&) override {}
    void volume(const engines::VolumePlane&) override {}
    void solved(const engines::SolverReport&) override {}
    void save(StateWriter&) override {}
    void restore(const StateReader&) override {}
    /// Collective, once, after the engine. Throws CaseFailure on all ranks together.
    virtual void finish() = 0;

protected:
    const Case& case_;
    const Comm& team_;
    engines::Slab slab_; // of this rank
};

/// The frame nearest to a time, from 0.
std::ptrdiff_t frame_at(const Case& c, double t_s);

/// The rows of the surface that a slab holds.
inline DistributedRows surface_rows(const Domain& domain, const engines::Slab& slab) {
    return {domain.nx, slab.x_start, slab.x_count, domain.ny};
}

/// Arrays of which every rank saves its own part. With the same number of ranks, each rank restores
/// its part bit for bit; otherwise each rank receives several parts or none, which `take` combines.
class RankParts {
public:
    explicit RankParts(const Comm& team) : team_(team) {}
    /// Once per checkpoint. Collective, as all functions here.
    void save_ranks(StateWriter& state) const;
    void save(StateWriter& state, const std::string& name, const std::vector<double>& mine) const;
    /// Calls `take` with each part of `length` numbers that belongs to this rank.
    void restore(const StateReader& state, const std::string& name, std::size_t length,
                 const std::function<void(std::span<const double>)>& take) const;

private:
    const Comm& team_;
};

/// The sums of every frame at every depth (measures/surface_sums.hpp).
class FrameSums : public Recording {
public:
    FrameSums(const Case& c, const Comm& team);
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    /// Throws FieldDiverges when the field is not finite.
    void finish() override;

    const std::vector<measures::DepthSeries>& depths() const { return depths_; }

private:
    measures::Region region_;
    std::vector<measures::DepthSeries> depths_;
};

/// The time mean of u_z^2 over the period window, of the first depth [m^2].
class MeanEnergy : public Recording {
public:
    MeanEnergy(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override { all_ = team_.gather(rows_); }

    /// (x, y) row-major. On rank 0 only; empty elsewhere, and when no window fits.
    const std::vector<double>& values() const { return all_; }

private:
    std::vector<double> weights_; // of each frame, with sum 1; empty: no window fits
    std::vector<double> rows_;    // of this rank so far
    std::vector<double> all_;
};

/// The level of sensation in the measured region, if the case computes it.
class SensationLevels : public Recording {
public:
    SensationLevels(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// The complete map. On rank 0 only; empty elsewhere, and for a case without levels.
    const measures::SensationMap& map() const { return map_; }

private:
    DistributedRows rows() const;

    std::size_t surface_ = 0; // index of the depth 0
    std::optional<measures::SensationSums> sums_;
    measures::SensationMap map_;
};

/// The contribution of the rows of this rank to the value at a point of the plane, by cubic
/// Lagrange interpolation; the sum over the ranks is the value.
double value_at(Vec2 at_m, View2<const double> values, const Domain& domain,
                const engines::Slab& slab);

/// u_z at some points of the surface, at every frame: the traces of a case, or the pins of its
/// afferents.
class PointSeries : public Recording {
public:
    /// `name`: that of the series in checkpoints.
    PointSeries(const Case& c, const Comm& team, std::string name, const std::vector<Vec2>& at_m);
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    const std::vector<measures::TraceSeries>& series() const { return series_; }

private:
    std::string name_;
    std::vector<measures::TraceSeries> series_;
};

/// The stress at the receptors of a case [Pa], compression positive; 0 off the domain.
class ReceptorSeries : public Recording {
public:
    using Recording::Recording;
    /// Positions and, for each, the index of its depth. Call before the run. Collective.
    void record_at(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths);
    void stress(const engines::StressFrame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    const std::vector<measures::TraceSeries>& series() const { return series_; }

private:
    std::vector<measures::TraceSeries> series_;
    std::vector<std::size_t> depths_; // of each
};

/// The displacement along the line of sight of a vibrometer at the points of its scan, averaged
/// over the spot, at every frame.
class ScanSeries : public Recording {
public:
    ScanSeries(const Case& c, const Comm& team);
    void frame(const engines::Frame& frame) override;
    void tangential(const engines::TangentialFrame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// One row of frames per point [m]; empty without a vibrometer.
    const std::vector<double>& displacements_m() const { return displacements_m_; }

private:
    void add(std::ptrdiff_t number, double factor, View2<const double> values);

    std::vector<double> displacements_m_;
};

/// The frames that a case stores: all, or those closest to the requested snapshots.
std::vector<std::ptrdiff_t> recorded_frames(const Case& c);

/// Passes the frames and volumes that a case stores to its file.
class StoredFields : public Recording {
public:
    StoredFields(const Case& c, const Comm& team, storage::CaseFileWriter& writer);
    void frame(const engines::Frame& frame) override;
    void volume_levels(const std::vector<double>& z_m) override;
    void volume(const engines::VolumePlane& plane) override;
    /// Flushes the data stored so far to the disk.
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    /// Throws CaseFailure when a volume is not complete.
    void finish() override;

private:
    storage::CaseFileWriter& writer_;
    std::vector<std::ptrdiff_t> frames_;
    double volume_planes_ = 0.0; // so far
};

/// Keeps the surface of all frames in single precision. Not saved in checkpoints.
class SurfaceFrames : public Recording {
public:
    /// `all`: on rank 0, the frames with the shape [frame][x][y] after finish(). Its memory is kept
    /// between cases.
    SurfaceFrames(const Case& c, const Comm& team, std::vector<float>& all)
        : Recording(c, team), all_(all) {}
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void finish() override;

private:
    std::vector<float>& all_; // of this rank until finish(), [frame][x of this rank][y]
};

/// Stores the surface at the instant `measure.at` and fits the angle of the wake to it.
class InstantSurface : public Recording {
public:
    InstantSurface(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override;
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// On rank 0 only; empty elsewhere.
    const std::optional<measures::MachFit>& mach() const { return mach_; }

private:
    measures::MachFit fit(const std::vector<double>& surface) const;

    std::ptrdiff_t instant_;
    std::vector<double> rows_;
    // Whether the frame of the instant was received; this rank may have no rows of it.
    bool has_instant_ = false;
    std::optional<measures::MachFit> mach_;
};

} // namespace shearwake::pipeline
