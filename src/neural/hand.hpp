#pragma once

#include "neural/afferent.hpp"
#include "neural/polygon.hpp"

#include <string>
#include <vector>

namespace shearwake::neural {

enum class SkinKind { palm, finger, tip };

/// A part of the hand whose skin is alike.
struct HandRegion {
    std::string name; // "palm"; "D2p", "D2m", "D2d": digit (1: thumb), proximal to distal
    SkinKind kind;
    Polygon outline_mm;
};

/// The palmar side of a right hand of 166 cm2. Origin: the pad of the index finger; x runs along it
/// towards the wrist, y from the thumb towards the little finger.
struct Hand {
    std::vector<HandRegion> regions;
    Polygon outline_mm; // of them all
};

/// Drawn for this program: five fingers, each a chain of tapering phalanges with a rounded end, and
/// a palm. Their places, directions and sizes are fitted to the areas, centres and boxes of the
/// regions of the hand in Saal et al. (PNAS 2017); breadths of joints agree with those of Garrett,
/// Human Factors 13 (1971) 117, to 3 mm.
Hand make_hand();

/// The region of that name. Throws Error if there is none.
const HandRegion& region(const Hand& hand, const std::string& name);

/// Fibres a square centimetre: Johansson and Vallbo, J. Physiol. 286 (1979) 283, as Saal et al.
/// (PNAS 2017) have them for palm, finger and tip.
double density_per_cm2(AfferentClass kind, SkinKind skin);

} // namespace shearwake::neural
