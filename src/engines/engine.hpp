#pragma once

#include "base/view.hpp"
#include "engines/checkpoint.hpp"
#include "model/case.hpp"
#include "parallel/comm.hpp"

#include <memory>
#include <string>
#include <vector>

namespace shearwake {

/// Rows of the surface grid that this rank holds: global rows x_start ... x_start + x_count - 1.
struct Slab {
    std::ptrdiff_t x_start = 0;
    std::ptrdiff_t x_count = 0;
};

/// One output time at one depth.
struct Frame {
    std::ptrdiff_t number = 0; // 0 .. TimeAxis::frames - 1, at TimeAxis::frame_s(number)
    std::size_t depth = 0;     // index into MeasureOptions::depths_m
    View2<const double> u_z_m; // x_count rows of ny values
};

/// One output time at one depth of a case that asks for the stress there.
struct StressFrame {
    std::ptrdiff_t number = 0;          // as of a Frame
    std::size_t depth = 0;              // index into stress_depths_m(case)
    View2<const double> compression_Pa; // -sigma_zz, x_count rows of ny values
};

/// One level of one component of a volume snapshot.
struct VolumePlane {
    std::size_t snapshot = 0;   // index into RecordOptions::volumes_s
    std::size_t field = 0;      // index into RecordOptions::volume_fields
    std::size_t component = 0;  // index into components_of(the field)
    std::size_t level = 0;      // index into the levels
    View2<const double> values; // x_count rows of ny values, in the field's SI unit
};

/// What some nodes have heard of a field in every step.
struct SensorSeries {
    std::string field;
    bool velocity = false;      // m/s, else Pa
    std::ptrdiff_t samples = 0; // of each node
    std::vector<double> values; // [node][sample]
};

/// What a case took, and what the engine chose for it and why. The same on all ranks.
struct SolverReport {
    std::vector<std::string> notes;     // one line each
    std::ptrdiff_t steps = 0;           // none: the engine does not step
    std::ptrdiff_t iterations = 0;      // of its linear solver, in all
    std::ptrdiff_t most_iterations = 0; // in one step
    // Of the load; and what still moves and strains the medium half a step before the end.
    double work_J = 0.0, energy_J = 0.0;
    std::vector<SensorSeries> sensors = {}; // of a grid study; on rank 0 only
};

/// Receives the field of a case as the engine produces it. Called on every rank of the team, in
/// the same order, also where the slab is empty; an observer must not throw on one rank only.
class Observer {
public:
    virtual ~Observer() = default;
    virtual void begin(const Slab& slab) = 0;
    virtual void frame(const Frame& frame) = 0;
    /// The stress at the depths of receptors, for cases that ask for it: after its frame.
    virtual void stress(const StressFrame& /*frame*/) {}
    /// The depths of the volume's levels, where a case keeps volumes: once, after `begin` and
    /// before `restore`. Collective.
    virtual void volume_levels(const std::vector<double>& /*z_m*/) {}
    /// In any order, within the snapshot's frame or before the next one. Collective.
    virtual void volume(const VolumePlane& /*plane*/) {}
    /// Once, after the last frame, by engines that have something to tell. Collective.
    virtual void solved(const SolverReport& /*report*/) {}
    /// What the frames so far have left, for a run that goes on later with the next one; restored
    /// after `begin`. Collective; called by engines within their own save and restore.
    virtual void save(StateWriter& /*state*/) {}
    virtual void restore(StateReader& /*state*/) {}
};

/// What a case needs.
struct Estimate {
    double memory_per_rank_B = 0.0;
    double seconds = 0.0;        // on one rank, everything shared already there
    double shared_seconds = 0.0; // once per medium and grid, on one rank
    int useful_ranks = 1;        // more have no slab
    // Of engines whose steps transpose the grid: how often, and bytes of all ranks each time. 0: a
    // plane a frame and depth.
    double all_to_alls = 0.0, all_to_all_B = 0.0;
};

/// Turns a case into frames of u_z. Keeps nothing between cases but what may be shared on purpose.
class Engine {
public:
    virtual ~Engine() = default;
    /// Not collective. `ranks`: of the team that would run it.
    virtual Estimate estimate(const Case& c, int ranks) const = 0;
    /// What it will choose for the case and why, one line each, as far as the case alone tells.
    /// Not collective.
    virtual std::vector<std::string> choices(const Case& /*c*/) const { return {}; }
    /// Collective over the team; always the same team for one engine.
    /// Throws CaseFailure on all ranks together. With `checkpoints` it goes on from the newest
    /// state, and returns early after a save when they say stop; engines whose cases take seconds
    /// ignore them.
    virtual void run(const Case& c, const Comm& team, Observer& observer,
                     Checkpoints* checkpoints = nullptr) = 0;
};

/// The engine that the case's solver options name.
std::unique_ptr<Engine> make_engine(const SolverOptions& solver);

} // namespace shearwake
