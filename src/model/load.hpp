#pragma once

#include "model/footprint.hpp"
#include "model/modulation.hpp"

#include <span>
#include <variant>
#include <vector>

namespace shearwake {

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
/// tissue, from t = 0 to off_time_s. Of n foci at a time each has a share 1/n of the peak. An
/// array's G changes with its focus, and peak is what it reaches with a single focus straight below
/// it.
struct Load {
    double peak_Pa = 0.0;
    Footprint footprint;
    Carrier carrier;
    Modulation modulation;
    bool operator==(const Load&) const = default;
};

/// e(t) c(t) at time t, also past the end of the path.
double amplitude(const Load& load, double t_s);

/// Force over peak_Pa without e(t) c(t), at each of these ascending times [m^2].
std::vector<double> force_areas_m2(const Load& load, std::span<const double> times_s);

/// The force of the whole footprint at time t [N]; 0 before t = 0 and after the path has ended.
double force_N(const Load& load, double t_s);

} // namespace shearwake
