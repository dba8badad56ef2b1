#pragma once

#include "base/vec2.hpp"
#include "neural/lines.hpp"

#include <vector>

namespace shearwake::neural {

/// Rigid circular pins of one radius that press on the skin, and how far.
struct PinStimulus {
    std::vector<Vec2> at_mm;
    double radius_mm = 1.0;
    double rate_Hz = 5000.0; // samples a second
    Lines indentation_mm;    // a line a pin, positive into the skin
};

/// The skin of the contact problem: a frictionless elastic half-space.
inline constexpr double youngs_modulus_MPa = 0.05;
inline constexpr double poisson_ratio = 0.4;

/// The radius with which pins at these places do not overlap: half their smallest distance, if the
/// given one is larger.
double fitting_radius_mm(const std::vector<Vec2>& at_mm, double radius_mm);

/// Sinking [mm] of the surface at distance r from the middle of a flat pin of radius a, for a load
/// of (1 - nu^2)/E: 1/(2a) below the pin, asin(a/r)/(pi a) beside it (Sneddon 1946, eq. 6.4).
double sinking_profile(double distance_mm, double radius_mm);

/// Loads P [N] of the pins that give the indentations, a line a pin, each sample for itself:
///     sum_q D_pq P_q = |s_p|,   D_pq = (1 - nu^2)/E sinking_profile(distance of p and q),
/// over the pins that press. Pins that would have to pull (P < 0) are let go all at once and the
/// others solved again, until none is left. Where s < 0, P gets its sign: a pin that is glued on.
Lines loads_N(const PinStimulus& stimulus);

/// dP/dt [N/s]: central differences, both ends copied from their neighbours; 0 for a single sample.
Lines load_rates_N_s(const Lines& loads, double rate_Hz);

} // namespace shearwake::neural
