// SPDX-License-Identifier: BSD-3-Clause
#include "problem/case/image_uplift.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace shearwake {
namespace {

/// Mirror images decrease as n^-3 and alternate: the first term that is omitted bounds the rest.
constexpr int mirror_images = 50;

/// The thickness above a rigid base, infinite on a half-space.
double depth_m(const Medium& medium) {
    if (medium.base == Base::half_space) return std::numeric_limits<double>::infinity();
    double sum_m = 0.0;
    for (const Layer& layer : medium.layers)
        sum_m += layer.thickness_m;
    return sum_m;
}

/// integral of 1/r^3 from r = radius to infinity, times r, for the flow in a layer: 1/radius, and
/// the images of the load in the base and in the surface.
double integral_beyond(double radius_m, double thickness_m) {
    double sum = 1.0 / radius_m;
    if (std::isinf(thickness_m)) return sum;
    for (int n = 1; n <= mirror_images; ++n) {
        const double z_m = 2.0 * n * thickness_m;
        const double term =
            2.0 * radius_m * radius_m * std::pow(radius_m * radius_m + z_m * z_m, -1.5);
        sum += n % 2 ? -term : term;
    }
    return std::max(sum, 0.0);
}

} // namespace

std::vector<double> image_uplift_m(const Case& c) {
    const double width_m = c.domain.extent_x_m(), height_m = c.domain.extent_y_m();
    // The disc with the same integral of 1/r^3 outside of it as outside of the rectangle.
    const double radius_m =
        std::numbers::pi / 4.0 * width_m * height_m / std::hypot(width_m, height_m);
    const Layer& top = c.scene().medium.layers.front();
    const double per_moment = integral_beyond(radius_m, depth_m(c.scene().medium)) /
                              (top.density_kg_m3 * width_m * height_m);
    const double dt_s = c.time.interval_s;
    const auto frames = static_cast<std::size_t>(c.time.frames);
    const double steps = std::ceil(std::min(width_m, height_m) / (top.c_p_m_s * dt_s));
    if (steps > static_cast<double>(frames)) return std::vector<double>(frames, 0.0);
    const auto delay = static_cast<std::size_t>(steps);
    Load averaged = c.scene().load;
    averaged.carrier = AveragedCarrier{};
    // The first and the second integral of the force over time, by the trapezoidal rule.
    std::vector<double> once(frames + 1, 0.0), twice(frames + 1, 0.0), uplift_m(frames, 0.0);
    std::vector<double> times_s;
    for (std::size_t n = 0; n <= frames; ++n)
        times_s.push_back(static_cast<double>(n) * dt_s);
    const std::vector<double> force_N = forces_N(averaged, times_s);
    for (std::size_t n = 1; n <= frames; ++n) {
        once[n] = once[n - 1] + 0.5 * dt_s * (force_N[n - 1] + force_N[n]);
        twice[n] = twice[n - 1] + 0.5 * dt_s * (once[n - 1] + once[n]);
        if (n < delay) continue;
        const std::size_t m = n - delay;
        uplift_m[n - 1] = per_moment * (twice[m] + static_cast<double>(delay) * dt_s * once[m]);
    }
    return uplift_m;
}

} // namespace shearwake
