// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/rigid_bodies.hpp"
#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"

#include <optional>
#include <vector>

namespace shearwake::spectral {

/// The direction in which a body crosses the whole periodic domain.
enum class Endless { no, along_x, along_y, both };
/// An infinitely long cylinder along x or y, or a box without orientation that is at least as wide
/// as the domain. Not collective.
Endless endless_along(const Body& body, const Domain& domain);

/// How much stiffer a body is than the layers around it: the smallest ratio of shear moduli, 0 for
/// a body without c_s_m_s. Not collective.
double stiffness_contrast(const Body& body, const Medium& medium);
/// The bodies that are marked as rigid. Not collective.
std::vector<Body> rigid_bodies(const Case& c);
/// Whether a body lies below a rigid body that is a complete layer. No load reaches it. Not
/// collective.
bool is_below_rigid_layer(const Body& body, const Medium& medium, const Domain& domain);
/// Whether a rigid body is neither a complete layer nor below one. Not collective.
bool has_markers(const Body& body, const Medium& medium, const Domain& domain);
/// How the rigid bodies with markers are constrained: as endless ones if all cross the domain along
/// the same axis, so that each wavenumber along it has a system of its own, and otherwise as lumps,
/// with one system for all.
enum class RigidTreatment { none, endless, lumps };
/// The treatment of the bodies of a case, decided once.
struct RigidPlan {
    /// Of a case in which all rigid bodies are marked. Not collective.
    RigidPlan(Case given);

    Case marked;
    /// The case that is solved. A rigid body that is a complete layer is at rest, and the medium
    /// ends at the top of the uppermost one, like one with a rigid base.
    Case c;
    /// The case without its rigid bodies: the material in their place is that of the surroundings,
    /// and forces at markers make it move rigidly.
    Case layers;
    std::vector<Body> bodies; // the rigid ones of c, all with markers
    RigidTreatment treatment = RigidTreatment::none;
    std::string why; // this treatment; one line; empty without such bodies
    std::vector<std::string>
        reasons; // per body of `marked`: why a stiff one is rigid or not; or empty
};
/// Marks those bodies as rigid whose contrast exceeds solver.spectral.rigid_above, unless they are
/// lighter than the layers around them, need more time as lumps than as elastic bodies, or are
/// rejected by rigid_limits(). Not collective.
RigidPlan rigid_plan(Case given);
/// Why a rigid body cannot move, as in "held by the rigid base", or an empty text if it can. Not
/// collective.
std::string reason_of_rest(const Body& body, const Medium& medium, const Domain& domain);

/// Errors for rigid bodies that the engine does not support: bodies that overlap or touch the
/// surface, and bodies that the grid does not resolve. Not collective.
std::vector<Remark> rigid_limits(const Case& c);
/// Warnings for receptors of stress that are at the depths of a body with markers or within
/// near_spacings of them, where they may lie inside it or too close to it. Not collective.
constexpr double near_spacings = 2.5;
std::vector<Remark> receptors_near_bodies(const Case& c);

/// The points of this rank's slab inside the rigid bodies of a case. The field that the engine
/// computes there is that of the material between the markers, which is at rest in the body only on
/// average; these functions replace it in planes [x_count][padded_ny]. Not collective.
class InsideBodies {
public:
    InsideBodies(const Case& c, const fft::SlabShare& share);

    /// Sets a component (0: x, 1: y, 2: z) of the displacement [m] at a depth to that of the
    /// bodies.
    void set_displacement(double depth_m, std::size_t component,
                          const std::vector<RigidMotion>& motions, double* plane) const;
    /// Sets strains and stresses to zero.
    void clear(double depth_m, double* plane) const;

private:
    /// Calls use(place in the plane, index of the body, offset from its centre).
    template <class Use>
    void each_point(double depth_m, const Use& use) const;

    std::vector<Body> bodies_;
    Domain domain_;
    fft::SlabShare share_;
};

} // namespace shearwake::spectral
