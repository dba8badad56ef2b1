// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/observer.hpp"
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

/// Memory of one rank before any case: the program, MPI and HDF5.
constexpr double program_B = 38e6;

/// An array, or arrays that belong together, on the rank on which they are largest.
struct Allocation {
    std::string name;
    double bytes = 0.0;
};

/// Resources that a case needs according to the plan of its engine.
struct Resources {
    std::vector<Allocation> arrays; // at the time when the engine uses most memory
    double work = 0.0;              // of all ranks, about 1 ns of a core each
    double shared_work = 0.0;       // done once for consecutive cases with the same `shared`
    std::string shared;             // identifies the data that cases share; empty: none
    int useful_ranks = 1;           // further ranks would have no rows
    double written_B = 0.0;         // volumes in the case file

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

/// What an engine offers for a case. Nothing outside of engines asks for the options of an engine.
struct Capabilities {
    Edges edges = Edges::periodic;  // what becomes of waves there
    bool steps_in_time = true;      // and saves checkpoints, from which a case is resumed
    bool has_open_edges = false;    // with domain.edges = "open"
    bool has_tangential = false;    // computes the tangential displacement of the surface
    bool is_driven_by_force = true; // otherwise the load prescribes the motion of the skin
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
class FrameSource {
public:
    virtual ~FrameSource() = default;
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
class Engine : public FrameSource {
public:
    /// The choices that the engine will make for the case with their reasons, one line each, as far
    /// as they follow from the case alone.
    virtual std::vector<std::string> choices(const Case& c) const = 0;
    /// Errors for parts of the case that the engine does not support, and warnings about those that
    /// it approximates, as far as they follow from the case alone at little cost.
    virtual std::vector<Remark> limits(const Case& c) const = 0;
    virtual Capabilities capabilities(const Case& c) const = 0;
    /// Chooses the step that `run` uses, if this takes about 0.1 s or more, because it requires
    /// trial runs or the materials of all nodes; otherwise empty. Refers to the engine and the
    /// case.
    virtual StepChooser step_chooser(const Case& c) const = 0;
    /// The refinement in time for an estimate of the error.
    virtual StepRefinement refine_time_step(const Case& c) const = 0;
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
