// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/view.hpp"
#include "engines/checkpoint.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"

#include <cmath>
#include <ctime>
#include <exception>
#include <functional>
#include <limits>
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

/// Passes everything on to another observer. A class that adds to one part overrides it and calls
/// the function of this class.
class ForwardingObserver : public Observer {
public:
    explicit ForwardingObserver(Observer& next) : next_(next) {}
    void begin(const Slab& slab) override { next_.begin(slab); }
    void frame(const Frame& frame) override { next_.frame(frame); }
    void stress(const StressFrame& frame) override { next_.stress(frame); }
    void tangential(const TangentialFrame& frame) override { next_.tangential(frame); }
    void volume_levels(const std::vector<double>& z_m) override { next_.volume_levels(z_m); }
    void volume(const VolumePlane& plane) override { next_.volume(plane); }
    void solved(const SolverReport& report) override { next_.solved(report); }
    void save(StateWriter& state) override { next_.save(state); }
    void restore(const StateReader& state) override { next_.restore(state); }

private:
    Observer& next_;
};

/// Memory of one rank before any case: the program, MPI and HDF5.
constexpr double program_B = 38e6;

/// An array, or arrays that belong together, on the rank on which they are largest.
struct Array {
    std::string name;
    double bytes = 0.0;
};

/// Resources that a case needs according to the plan of its engine.
struct Resources {
    std::vector<Array> arrays; // at the time when the engine uses most memory
    double work = 0.0;         // of all ranks, about 1 ns of a core each
    double shared_work = 0.0;  // done once for consecutive cases with the same `shared`
    std::string shared;        // identifies the data that cases share; empty: none
    int useful_ranks = 1;      // further ranks would have no rows
    double written_B = 0.0;    // volumes in the case file

    /// The program and all arrays.
    double memory_per_rank_B() const;
};

/// Size in bytes of the volumes of a case in its file, for the given number of depth levels.
double volumes_B(const Case& c, double levels);

/// Treatment of waves at the edges of the domain in x and y.
enum class Edges {
    periodic, // they continue at the opposite edge
    sponge,   // the margin Domain::sponge_m damps them (problem/case/edges.hpp)
    layer,    // an absorbing layer of the engine
    open,     // they leave for good: the plane is infinite
};

/// Options of the engine with half the time step, or with a smaller tolerance that has this effect.
struct StepRefinement {
    SolverOptions options;
    std::string change; // what differs: "half the time step, 5 us, "; empty: nothing
    double ratio = 2.0; // by which the step is smaller
};

/// The time for choosing a step has passed.
struct StepNotChosen : std::exception {};

/// The CPU time that choosing a step may take, from the construction on.
class ChoiceLimit {
public:
    ChoiceLimit() = default; // endless
    explicit ChoiceLimit(double most_s) : most_s_(most_s) {}
    bool is_finite() const { return std::isfinite(most_s_); }
    /// Throws StepNotChosen when the time has passed.
    void check() const {
        if (static_cast<double>(std::clock() - began_) > most_s_ * CLOCKS_PER_SEC)
            throw StepNotChosen{};
    }

private:
    double most_s_ = std::numeric_limits<double>::infinity();
    std::clock_t began_ = std::clock();
};

/// Computes the frames of u_z of a case. Between cases it keeps only what they can share.
class Solver {
public:
    virtual ~Solver() = default;
    /// Resources for running the case on a team of `ranks` ranks. Not collective.
    virtual Resources resources(const Case& c, int ranks) const = 0;
    /// Computes the case and passes the results to the observer. With `checkpoints` it resumes from
    /// the newest checkpoint, and returns early after a save if a stop was requested; an engine
    /// that saves no checkpoints returns without one. Throws CaseFailure on all ranks together.
    /// Collective over the team, which must be the same in all calls.
    virtual void run(const Case& c, const Comm& team, Observer& observer,
                     Checkpoints* checkpoints = nullptr) = 0;
};

/// Returns a time step [s]. Throws StepNotChosen.
using StepChooser = std::function<double(ChoiceLimit)>;

/// A solver that cases name (registry/make_engine.hpp). No function but run() is collective.
class Engine : public Solver {
public:
    /// The choices that the engine will make for the case with their reasons, one line each, as far
    /// as they follow from the case alone.
    virtual std::vector<std::string> choices(const Case& c) const = 0;
    /// Errors for parts of the case that the engine does not support, and warnings about those that
    /// it approximates, as far as they follow from the case alone at little cost.
    virtual std::vector<Remark> limits(const Case& c) const = 0;
    /// How the engine treats waves at the edges for this case.
    virtual Edges edges(const Case& c) const = 0;
    /// Chooses the step that `run` uses, if this takes about 0.1 s or more, because it requires
    /// trial runs or the materials of all nodes; otherwise empty. Refers to the engine and the
    /// case.
    virtual StepChooser step_chooser(const Case& c) const = 0;
    /// The refinement in time for an estimate of the error.
    virtual StepRefinement half_the_step(const Case& c) const = 0;
};

/// A choice of an engine. `key` is empty, or the key to change where the choice reduces the
/// accuracy.
struct Choice {
    std::string key, text;
};
/// The texts of all choices.
std::vector<std::string> notes_of(const std::vector<Choice>& choices);
/// Warnings about the choices that reduce the accuracy.
std::vector<Remark> warnings_of(const std::vector<Choice>& choices);

/// Errors if the case requests open edges or the periodic regime, for engines that step in time on
/// a periodic or absorbing domain.
std::vector<Remark> refused_edges(const Case& c);

/// Errors for the layers that are neither lossless nor Kelvin-Voigt, for engines that step in time.
std::vector<Remark> refused_losses(const Case& c);

} // namespace shearwake::engines
