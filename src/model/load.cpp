#include "model/load.hpp"

#include "base/overloaded.hpp"

#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

double sigma_m(const GaussianFootprint& g) {
    return g.fwhm_m / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
}

} // namespace

double pressure(const Footprint& footprint, double x_m, double y_m) {
    return std::visit(
        [&](const GaussianFootprint& g) {
            const double s = sigma_m(g);
            return std::exp(-(x_m * x_m + y_m * y_m) / (2.0 * s * s));
        },
        footprint);
}

double spectrum(const Footprint& footprint, double kx_rad_m, double ky_rad_m) {
    return std::visit(
        [&](const GaussianFootprint& g) {
            const double s2 = sigma_m(g) * sigma_m(g);
            const double k2 = kx_rad_m * kx_rad_m + ky_rad_m * ky_rad_m;
            return 2.0 * std::numbers::pi * s2 * std::exp(-0.5 * k2 * s2);
        },
        footprint);
}

double fwhm_m(const Footprint& footprint) {
    return std::visit([](const GaussianFootprint& g) { return g.fwhm_m; }, footprint);
}

double bandwidth_rad_m(const Footprint& footprint, double fraction) {
    return std::visit(
        [&](const GaussianFootprint& g) {
            return std::sqrt(-2.0 * std::log(fraction)) / sigma_m(g);
        },
        footprint);
}

double amplitude(const Load& load, double t_s) {
    const double c = std::visit(overloaded{
                                    [](const AveragedCarrier&) { return 1.0; },
                                    [&](const ResolvedCarrier& carrier) {
                                        return 1.0 + std::cos(2.0 * std::numbers::pi *
                                                              carrier.frequency_Hz * t_s);
                                    },
                                },
                                load.carrier);
    return gain(load.modulation.envelope, t_s) * c;
}

double force_N(const Load& load, double t_s) {
    if (t_s < 0.0 || t_s > off_time_s(load.modulation.trajectory)) return 0.0;
    return load.peak_Pa * spectrum(load.footprint, 0.0, 0.0) * amplitude(load, t_s);
}

} // namespace shearwake
