// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/work.hpp"

namespace shearwake::spectral::kinds {

// Seconds on a typical core of 2020. Unit of the solves: one mode, level, node of an element and
// step. Separate kinds for the first solve, for further solves of an iteration and for those of the
// forces of rigid bodies, each with data in caches or in memory.
inline constexpr engines::WorkKind of_solve = {"spectral.solve.cached", 2.2e-9};
inline constexpr engines::WorkKind of_far_solve = {"spectral.solve.memory", 2.8e-9};
inline constexpr engines::WorkKind of_iteration = {"spectral.iteration.cached", 1.9e-9};
inline constexpr engines::WorkKind of_far_iteration = {"spectral.iteration.memory", 2.3e-9};
inline constexpr engines::WorkKind of_reaction = {"spectral.reaction.cached", 1.9e-9};
inline constexpr engines::WorkKind of_far_reaction = {"spectral.reaction.memory", 2.3e-9};
inline constexpr engines::WorkKind of_factors = {"spectral.factors",
                                                 4e-9}; // per mode, level and squared nodes
inline constexpr engines::WorkKind of_materials = {"spectral.materials",
                                                   1.5e-7}; // per grid point and strain point
// Transfer of strains to planes and of stresses back; unit: one plane and point if cells fill every
// row.
inline constexpr engines::WorkKind of_transfer = {"spectral.transfer.cached", 4e-9};
inline constexpr engines::WorkKind of_far_transfer = {"spectral.transfer.memory", 9e-9};
/// The same by sums over a window of x; unit: one plane, ky, kx and point of the window.
inline constexpr engines::WorkKind of_window = {"spectral.window", 1.5e-10};
// Products with the matrices of a box; unit: one entry of a matrix.
inline constexpr engines::WorkKind of_box = {"spectral.box.cached", 6e-10};
inline constexpr engines::WorkKind of_far_box = {"spectral.box.memory", 8e-10};
inline constexpr engines::WorkKind of_cell = {"spectral.cell", 1e-8}; // per cell and component
inline constexpr engines::WorkKind of_sponge = {"spectral.sponge",
                                                1.1e-8}; // per value that the sponge acts on
/// Per point, frame and depth.
inline constexpr engines::WorkKind of_frame = {"spectral.frame", 7e-9};
inline constexpr engines::WorkKind of_displacement = {"spectral.volume.u",
                                                      1e-8}; // per point and level of a snapshot
/// Per point and level of a snapshot.
inline constexpr engines::WorkKind of_tensor = {"spectral.volume.tensor", 1e-7};
inline constexpr engines::WorkKind of_receptor_planes = {"spectral.receptor_stress",
                                                         2e-8}; // per point and plane of stress

} // namespace shearwake::spectral::kinds
