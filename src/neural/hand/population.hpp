// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "neural/hand/hand.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Fibres of a class in a region at its natural density. A square grid with the pitch h = 10 mm /
/// sqrt(density per cm2) covers the bounding box of the region, shifted randomly by up to h along x
/// and y. Each grid point is moved by N(0, (h/5)^2) along both axes and becomes a fibre if it is
/// inside the region. Its neuron is chosen from those of the class with equal probability. The
/// random numbers depend only on the seed, the region's name, the class and the grid point.
/// Therefore they are the same on every machine, and the fibres of a region do not depend on which
/// other regions are populated. Not collective.
std::vector<Afferent> populate(const HandRegion& region, AfferentClass kind, std::uint64_t seed);

/// Fibres of several regions and classes, ordered by region and then by class.
std::vector<Afferent> populate(std::span<const HandRegion> regions,
                               std::span<const AfferentClass> kinds, std::uint64_t seed);

/// One fibre of each class at every point of a regular grid around `center_mm`; the neurons are
/// chosen as in populate().
std::vector<Afferent> grid_of_afferents(Vec2 center_mm, Vec2 extent_mm, double pitch_mm,
                                        std::span<const AfferentClass> kinds, std::uint64_t seed);

} // namespace shearwake::neural
