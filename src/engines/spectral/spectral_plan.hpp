// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/march.hpp"
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/depth/depth_mesh.hpp"
#include "engines/spectral/lateral/box_response.hpp"
#include "engines/spectral/stepping/stages.hpp"
#include "engines/spectral/stepping/time_step.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::spectral {

/// Size of the laterally varying part of a medium.
struct VariationPlan {
    double points = 0.0; // strain points; each has `components` planes
    double components = 0.0;
    double cells = 0.0;         // cells with data, sum over all points
    double fullest_cells = 0.0; // on the rank with most cells
    double surfaces = 0.0;      // cells that surfaces of bodies cross, sum over all points
    bool iterates = false;      // whether every step takes iterations
    std::string why;            // it iterates or does not
    CellExtent extent;          // that of all cells
    std::optional<BoxGrid> box; // on which iterations take place

    double planes() const { return points * components; }
    /// Points of the window of a line over x of nx points that is transformed; 0 for FFTs.
    double window(std::ptrdiff_t nx) const;
};

/// The varying part of a medium on every `stride`-th grid point along x and y, which takes some
/// hundredths of a second and is the same for many cases of a sweep.
struct SampledVariation {
    VariationPlan sizes;              // without those of ranks, and without a box
    std::vector<double> cells_before; // of each sampled row, those of the rows before
    double stride = 1.0;
};

/// The decisions of the engine for a case, made once: `run` executes them, and the resources and
/// notes follow from them.
struct SpectralPlan {
    /// Decides which bodies are rigid, and chooses time step and mesh. Throws
    /// engines::StepNotChosen. Not collective.
    SpectralPlan(const Case& given, engines::ChoiceLimit limit);
    /// A plan with a given mesh and step.
    SpectralPlan(RigidPlan bodies, DepthMesh depth, TimeStep step)
        : rigid(std::move(bodies)), time(std::move(step)), mesh(std::move(depth)) {}

    RigidPlan rigid; // and the case
    TimeStep time;
    DepthMesh mesh;

    /// All decisions with their reasons, one line each, with the estimated errors if they are
    /// known. `varying`: the plan's, or that of the run. Not collective.
    std::vector<std::string> notes(const std::optional<ProbedErrors>& errors,
                                   const VariationPlan& varying) const;
    SpongePlan sponge(const VariationPlan& varying) const;
    /// Equal for plans whose sampled_variation() is equal.
    std::string key_of_variation() const;
    std::ptrdiff_t steps() const { return rigid.c.time.frames * time.per_frame; }
    /// By lateral_variation() on a part of the grid points. Not collective.
    SampledVariation sampled_variation() const;
    /// On a number of ranks.
    VariationPlan variation(const SampledVariation& sampled, int ranks) const;
    engines::Resources resources(const SampledVariation& sampled, int ranks) const;
    engines::Resources resources(int ranks) const { return resources(sampled_variation(), ranks); }
};

/// A warning if the estimated error exceeds the accuracy of the options. Not collective.
std::vector<Remark> accuracy_warnings(const Case& c, const ProbedErrors& errors);

/// How each body is treated: as rigid because the case or the engine says so, or as elastic, and
/// why a stiff one is elastic; one line each. Not collective.
std::vector<std::string> body_notes(const RigidPlan& plan);

/// Shear stiffnesses of elastic bodies and the map above the cap. Not collective.
std::vector<engines::Choice> cap_choices(const Case& c);

} // namespace shearwake::spectral
