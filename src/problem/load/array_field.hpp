// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/acoustics/patch.hpp"
#include "problem/load/footprint.hpp"

#include <complex>
#include <map>
#include <span>
#include <utility>
#include <vector>

namespace shearwake {

/// Sound pressure of one piston at unit strength, D(theta) e^{i k r} / r with the directivity D = 2
/// J1(k a sin theta) / (k a sin theta), at the distance `offset_m` along the skin from the point
/// below it [1/m].
std::complex<double> piston_pressure(const ArrayFootprint& array, double offset_m);

/// The numbers of the pistons among drives() in the order of the files of OpenMPD's boards: by
/// column, and for each column from the last row.
using BoardOrder = std::map<std::pair<std::ptrdiff_t, std::ptrdiff_t>, std::size_t>;
BoardOrder board_order(const ArrayFootprint& array);

/// |p|^2 on the skin below an array, divided by its value at a focus directly below the centre.
///
/// All pistons and samples are on one lattice, whose spacing divides the pitch, so that a single
/// table of offsets contains the pressure of every piston at every sample. A pattern then requires
/// pistons times samples multiplications, about 2 ms. The spacing is at most lambda / 6.5, below
/// which |p|^2 varies by less than 1e-10 of its peak. Each pattern is multiplied by fading() at the
/// distance r from its centre, since the side lobes of the array
/// are unbounded but a patch is not.
class ArrayField {
public:
    /// `furthest_m`: the largest offset along x or y of the centre of a pattern from that of the
    /// array.
    ArrayField(const ArrayFootprint& array, double furthest_m);

    double spacing_m() const { return spacing_m_; }
    /// The pattern, faded out around `middle_m`, of an array that focuses on all `foci_m`
    /// simultaneously with the power of one focus.
    Patch pattern(Vec2 middle_m, std::span<const Vec2> foci_m) const;
    std::vector<std::complex<double>> drives(std::span<const Vec2> foci_m) const;

private:
    const double* table_row(const std::vector<double>& table, std::ptrdiff_t offset) const;

    ArrayFootprint array_;
    std::ptrdiff_t per_pitch_;
    double spacing_m_, peak_;
    std::ptrdiff_t reach_; // half the side of the patch, in samples
    std::ptrdiff_t half_;  // offsets from -half_ to half_
    std::vector<double> re_, im_;
};

/// |sum of the pistons|^2 at (x, y) from the centre when all are in phase at (0, 0), divided by
/// that at (0, 0), without fade-out.
double pressure_below(const ArrayFootprint& array, double x_m, double y_m);

/// pressure_below() of one array at many points.
class PressureBelow {
public:
    explicit PressureBelow(const ArrayFootprint& array);
    double operator()(double x_m, double y_m) const;

private:
    ArrayFootprint array_;
    double amplitude_;
    std::vector<std::complex<double>> drives_; // of all pistons, of magnitude 1
};

/// Peak radiation pressure, p^2 / (rho c^2), directly below the centre, for pistons with p =
/// strength / r [Pa].
double peak_Pa(const ArrayFootprint& array, double strength_Pa_m, double air_density_kg_m3);

} // namespace shearwake
