// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "case/case.hpp"
#include "case/remark.hpp"

#include <vector>

namespace shearwake::spectral {

/// The direction in which a body crosses the whole periodic domain.
enum class Endless { no, along_x, along_y, both };
/// An infinitely long cylinder along x or y, or a box at least as wide as the domain. Not
/// collective.
Endless endless_along(const Body& body, const Domain& domain);

/// The bodies that the engine treats as rigid. Not collective.
std::vector<Body> rigid_bodies(const Case& c);
/// The case without its rigid bodies: the material in their place is that of the surroundings, and
/// forces at markers make it move rigidly. Not collective.
Case without_rigid_bodies(Case c);
/// Whether a rigid body cannot move: it is fixed or bonded to the rigid base. Not collective.
bool is_held(const Body& body, const Medium& medium);

/// Errors for rigid bodies that the engine does not support: lumps, bodies along different axes,
/// bodies that overlap or touch the surface, and bodies that the grid does not resolve. Not
/// collective.
std::vector<Remark> rigid_limits(const Case& c);

} // namespace shearwake::spectral
