// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/load.hpp"

#include "base/constants.hpp"
#include "base/overloaded.hpp"
#include "problem/load/load_pattern.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

namespace shearwake {
namespace {

/// Chebyshev nodes from `low_m` to `high_m`; one node if both are equal. The force of an array
/// varies smoothly over an eighth of its distance from the skin, so that the polynomial through the
/// nodes is accurate to 1e-5, and to 1e-7 for a single focus.
class Nodes {
public:
    Nodes(double low_m, double high_m, double distance_m) {
        constexpr double fewest = 5.0, per_distance = 16.0;
        const int last =
            high_m > low_m ? static_cast<int>(fewest + per_distance * (high_m - low_m) / distance_m)
                           : 0;
        for (int n = 0; n <= last; ++n)
            at_m_.push_back(last == 0 ? low_m
                                      : 0.5 * (low_m + high_m) -
                                            0.5 * (high_m - low_m) *
                                                std::cos(std::numbers::pi * n / last));
    }
    const std::vector<double>& at_m() const { return at_m_; }
    /// The factors of the values at the nodes in the polynomial through them, by the barycentric
    /// formula.
    std::vector<double> factors(double x_m) const {
        std::vector<double> factors;
        double sum = 0.0;
        for (std::size_t n = 0; n < at_m_.size(); ++n) {
            const double distance_m = x_m - at_m_[n];
            if (distance_m == 0.0) {
                factors.assign(at_m_.size(), 0.0);
                factors[n] = 1.0;
                return factors;
            }
            const bool is_end = n == 0 || n + 1 == at_m_.size();
            factors.push_back((n % 2 ? -1.0 : 1.0) * (is_end ? 0.5 : 1.0) / distance_m);
            sum += factors.back();
        }
        for (double& factor : factors)
            factor /= sum;
        return factors;
    }

private:
    std::vector<double> at_m_;
};

/// A smooth function of the position at all of these positions.
template <class F>
std::vector<double> smooth_values(const std::vector<Vec2>& at_m, double distance_m, F f) {
    Vec2 low = at_m.front(), high = low;
    for (const Vec2& at : at_m) {
        low = {std::min(low.x, at.x), std::min(low.y, at.y)};
        high = {std::max(high.x, at.x), std::max(high.y, at.y)};
    }
    const Nodes x(low.x, high.x, distance_m), y(low.y, high.y, distance_m);
    std::vector<double> values;
    if (x.at_m().size() * y.at_m().size() >= at_m.size()) {
        for (const Vec2& at : at_m)
            values.push_back(f(at));
        return values;
    }
    std::vector<double> nodes;
    for (const double node_x : x.at_m())
        for (const double node_y : y.at_m())
            nodes.push_back(f({node_x, node_y}));
    for (const Vec2& at : at_m) {
        const std::vector<double> along_x = x.factors(at.x), along_y = y.factors(at.y);
        double sum = 0.0;
        for (std::size_t i = 0; i < along_x.size(); ++i)
            sum += along_x[i] * std::inner_product(along_y.begin(), along_y.end(),
                                                   nodes.data() + i * along_y.size(), 0.0);
        values.push_back(sum);
    }
    return values;
}

/// A function of the position that is not smooth, at `most` positions and constant between. They
/// are irregular, so that a path that repeats is sampled at others each time.
template <class F>
std::vector<double> rough_values(const std::vector<Vec2>& at_m, std::size_t most, F f) {
    const std::size_t stride = at_m.size() / most + (at_m.size() % most > 0);
    std::vector<double> values;
    for (std::size_t n = 0; n < at_m.size(); ++n) {
        const double share = std::fmod(static_cast<double>(n / stride) / std::numbers::phi, 1.0);
        const auto within = static_cast<std::size_t>(share * static_cast<double>(stride));
        values.push_back(n % stride == 0 ? f(at_m[std::min(n + within, at_m.size() - 1)])
                                         : values.back());
    }
    return values;
}

/// Rounded phases jump as the focus moves, and so does the result of an iteration.
bool is_smooth(const ArrayFootprint& array, std::size_t foci) {
    return array.phase_levels == 0 && (array.hologram == Hologram::superposition || foci < 2);
}

} // namespace

double amplitude(const Load& load, double t_s) {
    const double c = std::visit(overloaded{
                                    [](const AveragedCarrier&) { return 1.0; },
                                    [&](const ResolvedCarrier& carrier) {
                                        return 1.0 + std::cos(two_pi * carrier.frequency_Hz * t_s);
                                    },
                                },
                                load.carrier);
    return gain(load.modulation.envelope, t_s) * c;
}

double strength(const Load& load, double t_s) {
    if (t_s < 0.0 || t_s > off_time_s(load.modulation.trajectory)) return 0.0;
    return amplitude(load, t_s);
}

double held_s(const Load& load, double t_s) {
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    if (!array || array->update_rate_Hz == 0.0) return t_s;
    // A sample at the time of an update uses the new focus.
    return std::floor(t_s * array->update_rate_Hz + 1e-9) / array->update_rate_Hz;
}

std::vector<double> force_areas_m2(const Load& load, std::span<const double> times_s,
                                   std::size_t most_rough) {
    if (times_s.empty()) return {};
    LoadPattern pattern(load, times_s.back());
    const auto area_at = [&](Vec2 focus_m) {
        const double k_zero = 0.0;
        std::complex<double> area;
        pattern.set_focus(focus_m);
        pattern.spectra(0.0, {&k_zero, 1}, {&area, 1});
        return area.real();
    };
    std::vector<Vec2> foci_m;
    for (const double t_s : times_s)
        foci_m.push_back(position(load.modulation.trajectory, pattern.held_s(t_s)));
    const auto* array = std::get_if<ArrayFootprint>(&load.footprint);
    if (!array || !pattern.changes())
        return std::vector<double>(times_s.size(), area_at(foci_m.front()));
    return is_smooth(*array, load.modulation.foci_m.size())
               ? smooth_values(foci_m, array->distance_m, area_at)
               : rough_values(foci_m, most_rough, area_at);
}

std::vector<double> forces_N(const Load& load, std::span<const double> times_s) {
    std::vector<double> forces = force_areas_m2(load, times_s);
    for (std::size_t n = 0; n < forces.size(); ++n)
        forces[n] *= load.peak_Pa * strength(load, times_s[n]);
    return forces;
}

} // namespace shearwake
