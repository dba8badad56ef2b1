// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/vectors.hpp"
#include "neural/hand/hand.hpp"

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

namespace shearwake::neural {

/// Time series of equal length, one per pin or one per afferent.
struct Lines {
    std::size_t count = 0, samples = 0;
    std::vector<double> values; // line by line

    Lines() = default;
    Lines(std::size_t lines, std::size_t samples_a_line)
        : count(lines), samples(samples_a_line), values(lines * samples_a_line) {}
    bool operator==(const Lines&) const = default;

    std::span<double> line(std::size_t i) {
        return std::span(values).subspan(i * samples, samples);
    }
    std::span<const double> line(std::size_t i) const {
        return std::span(values).subspan(i * samples, samples);
    }
};

/// Rigid circular pins of equal radius that press on the skin, and their indentations.
struct PinStimulus {
    std::vector<Vec2> at_mm;
    double radius_mm = 1.0;
    double rate_Hz = 5000.0; // samples per second
    Lines indentation_mm;    // one line per pin, positive into the skin
};

/// The skin of the contact problem: a frictionless elastic half-space.
inline constexpr double youngs_modulus_MPa = 0.05;
inline constexpr double poisson_ratio = 0.4;

/// The given radius, or half of the smallest distance of the pins if the pins would overlap
/// otherwise.
double fitting_radius_mm(const std::vector<Vec2>& at_mm, double radius_mm);

/// Indentation [mm] of the surface at distance r from the centre of a flat pin of radius a, for a
/// load of (1 - nu^2)/E: 1/(2a) below the pin, asin(a/r)/(pi a) outside (Sneddon 1946, eq. 6.4).
double sinking_profile(double distance_mm, double radius_mm);

/// Loads P [N] of the pins that cause the indentations, one line per pin, separately for each
/// sample:
///     sum_q D_pq P_q = |s_p|,   D_pq = (1 - nu^2)/E sinking_profile(distance of p and q),
/// over the pins in contact. Pins with P < 0 are released together and the others are solved again
/// until no pin would pull. Where s < 0, P takes this sign: the pin is glued to the skin. Not
/// collective.
Lines loads_N(const PinStimulus& stimulus);

/// dP/dt [N/s] by central differences; both ends are copied from their neighbours. 0 for a single
/// sample.
Lines load_rates_N_s(const Lines& loads, double rate_Hz);

/// Path lengths of waves from every pin to a receptor [mm]; infinite without a path.
using SkinPaths = std::function<std::vector<double>(Vec2 receptor_mm)>;

/// Straight lines on an unbounded flat sheet of skin.
SkinPaths straight_paths(std::vector<Vec2> pins_mm);

/// Shortest paths that stay within an outline: around the corners between fingers, not across the
/// gap. A shortest path bends only at reflex corners of the outline. The paths are therefore found
/// exactly by Dijkstra's algorithm on the visibility graph. There are no paths from or to points
/// outside of the skin. Not collective.
SkinPaths paths_within(const Polygon& outline_mm, std::vector<Vec2> pins_mm);

/// Speed of the wave that transports a pin's motion along the skin. No function here is collective.
inline constexpr double wave_speed_mm_s = 8000.0;

/// Axial stress at depth z and distance r from the centre of a flat pin of radius a, per load
/// [1/mm2], positive in compression (Sneddon 1946, eq. 6.7 and its integrals J01, J02):
///     (J01 + xi J02) / (2 pi a^2),   xi = z/a,  rho = r/a.
double stress_per_load(double distance_mm, double depth_mm, double radius_mm);

/// Delay of the wave of a pin's motion at a distance from the pin's centre, rounded to an integer
/// number of samples (ties to even).
std::size_t arrival_samples(double distance_mm, double radius_mm, double rate_Hz);

/// Gain from a pin's load rate to the dynamic term of a receptor [1/mm3]: sinking_profile(distance)
/// / depth^2; 0 at infinite distance.
double wave_gain(double distance_mm, double depth_mm, double radius_mm);

} // namespace shearwake::neural
