// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/load/array_field.hpp"
#include "problem/load/load.hpp"

#include <complex>
#include <optional>
#include <span>

namespace shearwake {

/// The pattern of the load on the skin as the focus moves, divided by peak_Pa, and its spectrum.
/// The pattern of Gaussian foci only moves. That of an array is recomputed for each position of the
/// focus, since steering changes it. That of a lens is static. All are exact at all requested
/// times, without interpolation.
class LoadPattern {
public:
    /// Supports times up to `until_s`; for an array, later times are replaced by it.
    LoadPattern(const Load& load, double until_s);

    /// Whether the pattern changes as the focus moves.
    bool changes() const { return changes_; }
    /// The time whose focus is active at t, since an array updates it at its update rate [s].
    double updated_s(double t_s) const;
    /// Selects the pattern of that time.
    void set(double updated_s);
    /// Selects the pattern of a position of the focus within the bounds of the path.
    void set_focus(Vec2 at_m);
    /// The origin of the spectra [m].
    Vec2 origin_m() const { return origin_m_; }
    /// Spectra at one ky and some kx [m^2].
    void spectra(double ky_rad_m, std::span<const double> kx_rad_m,
                 std::span<std::complex<double>> out) const;
    /// Spectra are zero beyond this |kx| or |ky|.
    double band_rad_m() const;

private:
    Load load_;
    double until_s_;
    bool changes_ = false;
    std::optional<ArrayField> field_;
    Patch patch_; // empty for Gaussian foci; of a lens: relative to its axis
    Vec2 origin_m_;

    friend LoadPattern unsteered_pattern(const Load& load);
};

/// With the pattern of an array below its centre, which only moves. A steered pattern changes
/// slowly compared with the phases of its moving focus, and thousands of them take minutes.
LoadPattern unsteered_pattern(const Load& load);

} // namespace shearwake
