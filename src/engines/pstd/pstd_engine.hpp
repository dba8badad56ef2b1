// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/units.hpp"
#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/pstd/make_scheme.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "engines/pstd/scene/displacements.hpp"

#include <functional>
#include <optional>
#include <utility>
#include <vector>

namespace shearwake::pstd {

/// k-Wave's staggered pseudospectral scheme (scheme/scheme.hpp) for a case. It is explicit in
/// time; the fastest wave limits the step, so that c_p is capped at a multiple of c_s. Supports
/// layers, bodies and maps that are Kelvin-Voigt or lossless, and Gaussian foci. Waves are absorbed
/// below the medium, and above it unless there is nothing. Passes the frames in order of time, each
/// at all depths.
class PstdEngine : public engines::Engine {
public:
    engines::Resources resources(const Case& c, int ranks) const override;
    std::vector<std::string> choices(const Case& c) const override;
    std::vector<Remark> limits(const Case& c) const override;
    engines::Capabilities capabilities(const Case& c) const override;
    /// The limits of the step follow from all nodes, which takes long where the medium varies
    /// laterally.
    engines::StepChooser step_chooser(const Case& c) const override;
    engines::StepRefinement refine_time_step(const Case& c) const override;
    void run(const Case& c, const Comm& team, engines::Observer& observer,
             engines::Checkpoints* checkpoints) override;

private:
    /// The step that `run` uses, with the limits of the grid. Not collective.
    const StepChoice& step_of(const Case& c, engines::ChoiceLimit limit = {}) const;
    mutable std::optional<std::pair<Case, StepChoice>> step_; // of the last case
};

/// The decisions of the engine for a case: `run` executes them, and the resources follow from them.
struct PstdPlan {
    Grid grid;
    PmlOptions pml;
    double steps = 0.0;
    Absorption absorption = Absorption::none;
    Precision precision = Precision::double_precision;
    DeviceChoice device = {};
    bool uneven = false;       // materials are given per node
    double coefficients = 0.0; // of the stepper, that are stored per node
    double source_nodes = 0.0; // of all ranks
    FramePlaces places;
    std::ptrdiff_t per_frame = 1; // steps
    std::ptrdiff_t levels = 0;    // of volumes
};

/// A run of a plan.
struct PstdRun {
    std::function<Setup()> setup; // called on all ranks together
    const CaseGrid& grid;
    engines::SolverReport report; // notes and warnings
};
/// Collective.
void run_plan(const Case& c, const PstdPlan& plan, const PstdRun& run, const Comm& team,
              engines::Observer& observer, engines::Checkpoints* checkpoints);

/// Which properties of a medium vary laterally.
struct Variations {
    bool density = true, speeds = true, viscosity = true;
};
/// Number of coefficients of a stepper that vary laterally with these properties.
double varying_coefficients(const Variations& vary, Absorption absorption);

/// Grid, absorbing layer, precision and materials; one line. Not collective.
std::string note_of(const PstdPlan& plan);

/// The arrays of the rank with most planes. Not collective.
std::vector<engines::Allocation> arrays_of(const PstdPlan& plan, int ranks);
/// Not collective.
engines::Resources resources_of(const Case& c, const PstdPlan& plan, int ranks);

} // namespace shearwake::pstd
