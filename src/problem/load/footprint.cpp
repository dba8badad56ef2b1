// SPDX-License-Identifier: BSD-3-Clause
#include "problem/load/footprint.hpp"

#include "base/units.hpp"
#include "problem/load/acoustics/lens_design.hpp"
#include "problem/load/array_field.hpp"
#include "problem/load/load.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <deque>
#include <numbers>
#include <numeric>

namespace shearwake {

namespace {

using Complex = std::complex<double>;

double sigma_m(const GaussianFootprint& g) {
    return g.fwhm_m / (2.0 * std::sqrt(2.0 * std::numbers::ln2));
}

/// Where |p|^2 falls to a half, along a direction from the focus.
double half_width_m(const ArrayFootprint& array, Vec2 along) {
    const PressureBelow pressure(array);
    const auto at = [&](double r) { return pressure(r * along.x, r * along.y); };
    double low = 0.0, high = 0.1 * array.sound_speed_m_s / array.frequency_Hz;
    while (at(high) > 0.5) {
        low = high;
        high += 0.1 * array.sound_speed_m_s / array.frequency_Hz;
    }
    for (int i = 0; i < 50; ++i) {
        const double middle = 0.5 * (low + high);
        (at(middle) > 0.5 ? low : high) = middle;
    }
    return low;
}

/// Magnitudes of the transform of a patch at ascending wavenumbers k, the largest of three
/// directions. Along each of them it is the transform of sums over lines. Those that are asked for
/// are kept.
class Spectrum {
public:
    explicit Spectrum(const Patch& patch)
        : spacing_m_(patch.spacing_m), band_rad_m_(patch.band_rad_m()) {
        const auto side = static_cast<std::size_t>(patch.side);
        for (auto& sums : sums_)
            sums.resize(2 * side);
        for (std::size_t i = 0; i < side; ++i)
            for (std::size_t j = 0; j < side; ++j) {
                const double value = patch.values[i * side + j];
                sums_[0][i] += value;
                sums_[1][j] += value;
                sums_[2][i + j] += value;
            }
    }
    double bandwidth_rad_m(double fraction) {
        const double total = std::accumulate(sums_[0].begin(), sums_[0].end(), 0.0);
        const double least = fraction * std::abs(total);
        for (int i = steps; i > 0; --i)
            if (size(i) >= least) return band_rad_m_ * i / steps;
        return band_rad_m_ / steps;
    }

private:
    static constexpr int steps = 400;
    double size(int i) {
        double& size = sizes_[static_cast<std::size_t>(i)];
        if (size >= 0.0) return size;
        const double along = band_rad_m_ * i / steps * spacing_m_;
        for (std::size_t direction = 0; direction < sums_.size(); ++direction) {
            const Complex turn = std::polar(1.0, direction < 2 ? along : along * std::sqrt(0.5));
            Complex sum = 0.0, phase = 1.0;
            for (const double value : sums_[direction]) {
                sum += value * phase;
                phase *= turn;
            }
            size = std::max(size, std::abs(sum));
        }
        return size;
    }
    double spacing_m_, band_rad_m_;
    std::array<std::vector<double>, 3> sums_; // over y, over x, over lines of equal i + j
    std::vector<double> sizes_ = std::vector<double>(steps + 1, -1.0);
};

/// What is often asked of an array, for example for each case of a sweep.
struct KnownArray {
    explicit KnownArray(const ArrayFootprint& of) : array(of) {}
    /// Straight below the middle. The reader asks for the width of an array before it limits the
    /// samples of the pattern.
    const Patch& pattern() {
        const Vec2 focus = array.center_m;
        ArrayFootprint focused = array;
        focused.frames.reset();
        if (!patch) patch = ArrayField(focused, 0.0).pattern(focus, {&focus, 1});
        return *patch;
    }
    double fwhm_m() {
        if (!width_m)
            width_m =
                2.0 * std::sqrt(half_width_m(array, {1.0, 0.0}) * half_width_m(array, {0.0, 1.0}));
        return *width_m;
    }
    double bandwidth_rad_m(double fraction) {
        if (!spectrum) spectrum.emplace(pattern());
        return spectrum->bandwidth_rad_m(fraction);
    }

    std::size_t numbers() const { return 1000 + (patch ? patch->values.size() : 0); }

    ArrayFootprint array;
    std::optional<Patch> patch;
    std::optional<double> width_m;
    std::optional<Spectrum> spectrum;
};

/// The last arrays of this thread. They are computed in some ms each, more than all else that
/// validates a case.
KnownArray& known(const ArrayFootprint& array) {
    constexpr std::size_t most_numbers = 4'000'000; // 32 MB
    thread_local std::deque<KnownArray> all;
    std::size_t numbers = 0;
    for (KnownArray& one : all) {
        if (one.array == array) return one;
        numbers += one.numbers();
    }
    for (; numbers > most_numbers; all.pop_front())
        numbers -= all.front().numbers();
    return all.emplace_back(array);
}

} // namespace

double pressure(const Footprint& footprint, double x_m, double y_m) {
    return std::visit(overloaded{
                          [&](const GaussianFootprint& g) {
                              const double s = sigma_m(g);
                              return std::exp(-(x_m * x_m + y_m * y_m) / (2.0 * s * s));
                          },
                          [&](const ArrayFootprint& array) {
                              return pressure_below(array, x_m, y_m) *
                                     fading(array.reach_m, std::hypot(x_m, y_m));
                          },
                          [&](const LensFootprint& lens) {
                              return value_at(design_of(lens)->pattern, {x_m, y_m});
                          },
                      },
                      footprint);
}

double spectrum(const Footprint& footprint, double kx_rad_m, double ky_rad_m) {
    return std::visit(
        overloaded{
            [&](const GaussianFootprint& g) {
                const double s2 = sigma_m(g) * sigma_m(g);
                const double k2 = kx_rad_m * kx_rad_m + ky_rad_m * ky_rad_m;
                return two_pi * s2 * std::exp(-0.5 * k2 * s2);
            },
            [&](const ArrayFootprint& array) {
                return std::abs(transform(known(array).pattern(), kx_rad_m, ky_rad_m));
            },
            [&](const LensFootprint& lens) {
                return std::abs(transform(design_of(lens)->pattern, kx_rad_m, ky_rad_m));
            },
        },
        footprint);
}

double fwhm_m(const Footprint& footprint) {
    return std::visit(overloaded{
                          [](const GaussianFootprint& g) { return g.fwhm_m; },
                          [](ArrayFootprint array) { // does not depend on where it is faded out
                              array.reach_m = 0.0;
                              return known(array).fwhm_m();
                          },
                          [](const LensFootprint& lens) { return design_of(lens)->width_m; },
                      },
                      footprint);
}

std::optional<double> reach_m(const Footprint& footprint) {
    return std::visit(
        overloaded{
            [](const GaussianFootprint&) -> std::optional<double> { return std::nullopt; },
            [](const auto& faded) -> std::optional<double> { return faded.reach_m; },
        },
        footprint);
}

double bandwidth_rad_m(const Footprint& footprint, double fraction) {
    return std::visit(
        overloaded{
            [&](const GaussianFootprint& g) {
                return std::sqrt(-2.0 * std::log(fraction)) / sigma_m(g);
            },
            [&](const ArrayFootprint& array) { return known(array).bandwidth_rad_m(fraction); },
            [&](const LensFootprint& lens) {
                // Most cases of a sweep have the same lens.
                thread_local std::shared_ptr<const LensDesign> design;
                thread_local std::optional<Spectrum> known;
                if (std::shared_ptr<const LensDesign> own = design_of(lens); own != design) {
                    design = std::move(own);
                    known.emplace(design->pattern);
                }
                return known->bandwidth_rad_m(fraction);
            },
        },
        footprint);
}

namespace {

std::vector<Vec2> points_along(const Curve& path, double step_m) {
    const double length = length_m(path);
    const auto steps = std::max<std::ptrdiff_t>(1, std::lround(std::ceil(length / step_m)));
    std::vector<double> arcs;
    for (std::ptrdiff_t i = 0; i <= steps; ++i)
        arcs.push_back(length * static_cast<double>(i) / static_cast<double>(steps));
    const auto corners = corners_m(path);
    arcs.insert(arcs.end(), corners.begin(), corners.end());
    std::sort(arcs.begin(), arcs.end());
    std::vector<Vec2> points;
    for (const double arc : arcs)
        points.push_back(point_m(path, arc));
    return points;
}

} // namespace

double update_rate_Hz(const Footprint& footprint) {
    return std::visit(overloaded{[](const GaussianFootprint&) { return 0.0; },
                                 [](const ArrayFootprint& array) { return array.update_rate_Hz; },
                                 [](const LensFootprint&) { return 0.0; }},
                      footprint);
}

std::vector<std::vector<Vec2>> drawn_shape(const Modulation& modulation, double step_m) {
    Vec2 rest{};
    std::optional<Curve> path, swing;
    for (const Mover& mover : modulation.trajectory.parts)
        std::visit(overloaded{[&](const Hold& hold) { rest = rest + hold.at_m; },
                              [&](const Swing& s) {
                                  if (!swing) swing = Curve(-1.0 * s.amplitude_m, s.amplitude_m);
                              },
                              [&](const Travel& travel) {
                                  if (!path) path = travel.path;
                              }},
                   mover);
    if (!path) path = swing;
    const std::vector<Vec2> line = path ? points_along(*path, step_m) : std::vector<Vec2>(1);

    std::vector<Vec2> foci = modulation.foci_m;
    if (foci.empty()) foci.push_back({});
    std::vector<std::vector<Vec2>> lines;
    for (const Vec2 focus : foci) {
        lines.push_back(line);
        for (Vec2& point : lines.back())
            point = point + rest + focus;
    }
    return lines;
}

} // namespace shearwake
