// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/remark.hpp"

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
/// The case with all bodies marked as rigid that the engine treats as such: those whose contrast
/// exceeds solver.spectral.rigid_above, unless they are lighter than the layers around them, add so
/// many markers of lumps that elastic bodies are faster, or are rejected by rigid_limits(). Not
/// collective.
Case with_rigid_bodies(Case c);

/// Whether the contrast of a body exceeds solver.spectral.rigid_above. Not collective.
bool is_stiff_enough(const Body& body, const Case& c);
/// Why an elastic body that is stiff enough is not treated as rigid, or an empty text if it is. Not
/// collective.
std::string obstacle(const Case& c, std::size_t body);

/// The bodies that are marked as rigid. Not collective.
std::vector<Body> rigid_bodies(const Case& c);
/// Whether a body lies below a rigid body that is a complete layer. No load reaches it. Not
/// collective.
bool is_below_rigid_layer(const Body& body, const Medium& medium, const Domain& domain);
/// Whether a rigid body is neither a complete layer nor below one. Not collective.
bool has_markers(const Body& body, const Medium& medium, const Domain& domain);
/// The rigid bodies with markers: the first list contains them if all cross the domain
/// along the same axis, so that each wavenumber along it is constrained by itself, the second one
/// otherwise. Not collective.
std::vector<Body> section_bodies(const Case& c);
std::vector<Body> lump_bodies(const Case& c);
/// The case without its rigid bodies: the material in their place is that of the surroundings, and
/// forces at markers make it move rigidly. Not collective.
Case without_rigid_bodies(Case c);
/// Why a rigid body cannot move, as in "held by the rigid base", or an empty text if it can. Not
/// collective.
std::string held_by(const Body& body, const Medium& medium, const Domain& domain);

/// Errors for rigid bodies that the engine does not support: bodies that overlap or touch the
/// surface, and bodies that the grid does not resolve. Not collective.
std::vector<Remark> rigid_limits(const Case& c);
/// Warnings for receptors of stress that are at the depths of a body with markers or within this
/// number of spacings of them, where they may lie inside it or too close to it: near_surface, or
/// near_edges for bodies with edges, at which the stress is singular. Not collective.
constexpr double near_surface = 0.4, near_edges = 1.5;
std::vector<Remark> receptors_near_bodies(const Case& c);

} // namespace shearwake::spectral
