#pragma once

#include "model/modulation.hpp"

#include <variant>

namespace shearwake {

/// Unit-peak Gaussian of radiation pressure; sigma = FWHM / (2 sqrt(2 ln 2)).
struct GaussianFootprint {
    double fwhm_m = 0.0;
    bool operator==(const GaussianFootprint&) const = default;
};
using Footprint = std::variant<GaussianFootprint>;

/// Pressure over the peak at distance (x, y) from the focus.
double pressure(const Footprint& footprint, double x_m, double y_m);
/// Its two-dimensional Fourier transform, integral of pressure e^{-i k.x} dx dy [m^2].
double spectrum(const Footprint& footprint, double kx_rad_m, double ky_rad_m);
/// Full width at half maximum [m].
double fwhm_m(const Footprint& footprint);
/// The |k| beyond which the spectrum stays below `fraction` of its largest value [rad/m].
double bandwidth_rad_m(const Footprint& footprint, double fraction);

/// The cycle-averaged pressure acts: c(t) = 1.
struct AveragedCarrier {
    bool operator==(const AveragedCarrier&) const = default;
};
/// c(t) = 1 + cos(2 pi f t): mean 1, never negative.
struct ResolvedCarrier {
    double frequency_Hz = 40e3;
    bool operator==(const ResolvedCarrier&) const = default;
};
using Carrier = std::variant<AveragedCarrier, ResolvedCarrier>;

/// Normal traction p(x, y, t) = peak G(x - x_f(t), y - y_f(t)) e(t) c(t) [Pa], positive into the
/// tissue, from t = 0 to off_time_s.
struct Load {
    double peak_Pa = 0.0;
    Footprint footprint;
    Carrier carrier;
    Modulation modulation;
    bool operator==(const Load&) const = default;
};

/// e(t) c(t) at time t, also past the end of the path.
double amplitude(const Load& load, double t_s);

/// The force of the whole footprint at time t [N]; 0 before t = 0 and after the path has ended.
double force_N(const Load& load, double t_s);

} // namespace shearwake
