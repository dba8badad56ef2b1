#pragma once

#include "neural/hand.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Fibres of a class in a region, as dense as they are there. A square grid with the pitch
/// h = 10 mm / sqrt(density per cm2) lies over the region's box, shifted at random by up to h along
/// x and y; each of its points is moved by N(0, (h/5)^2) along both and is a fibre if it is within
/// the region. Its neuron is any of the class with equal chance. Random numbers depend on the seed,
/// the region's name, the class and the point alone: the same on every machine, and a region has
/// the same fibres whichever others are populated.
std::vector<Afferent> populate(const HandRegion& region, AfferentClass kind, std::uint64_t seed);

/// Every region of the hand in its order, the classes in theirs.
std::vector<Afferent> populate(std::span<const HandRegion> regions,
                               std::span<const AfferentClass> kinds, std::uint64_t seed);

/// One fibre of each class at every point of a regular grid about `center_mm`; neurons as above.
std::vector<Afferent> grid_of_afferents(Vec2 center_mm, Vec2 extent_mm, double pitch_mm,
                                        std::span<const AfferentClass> kinds, std::uint64_t seed);

} // namespace shearwake::neural
