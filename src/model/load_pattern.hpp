#pragma once

#include "model/array_field.hpp"
#include "model/load.hpp"

#include <complex>
#include <optional>
#include <span>
#include <vector>

namespace shearwake {

/// The load's pattern on the skin as the focus moves, over peak_Pa, and its spectrum. Gaussian foci
/// take theirs along unchanged. An array's is computed anew for each place of its focus, since
/// steering changes it: exact at every time that is asked for, nothing is interpolated.
class LoadPattern {
public:
    /// Will be asked for times up to `until_s`; of an array later ones are that one.
    LoadPattern(const Load& load, double until_s,
                ArrayField::Sampling sampling = ArrayField::Sampling::fine);

    /// Whether the pattern changes as the focus moves.
    bool changes() const { return changes_; }
    /// The time whose focus acts at t: an array sets it at its update rate [s].
    double held_s(double t_s) const;
    /// The pattern of that time from now on.
    void set(double held_s);
    /// Where the spectra are seen from [m].
    Vec2 origin_m() const { return origin_m_; }
    /// Spectra at one ky and some kx [m^2].
    void spectra(double ky_rad_m, std::span<const double> kx_rad_m,
                 std::span<std::complex<double>> out) const;
    /// Beyond this |kx| or |ky| they are zero.
    double band_rad_m() const;

private:
    Load load_;
    double until_s_;
    bool changes_ = false;
    std::optional<ArrayField> field_;
    Patch patch_;
    Vec2 origin_m_;
};

} // namespace shearwake
