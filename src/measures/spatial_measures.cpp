// SPDX-License-Identifier: BSD-3-Clause
#include "measures/spatial_measures.hpp"

#include "base/units.hpp"
#include "measures/surface_sums.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>
#include <optional>
#include <span>
#include <vector>

namespace shearwake::measures {

double impulse_N_s(const Load& load, double until_s) {
    constexpr double steps_a_period = 100.0, fewest_steps = 10000.0;
    constexpr std::size_t most_rough = 400;
    const double end = std::min(until_s, off_time_s(load.modulation.trajectory));
    if (!(end > 0.0)) return 0.0;
    const double highest_Hz = greatest_envelope_frequency_Hz(load.modulation.envelope) +
                              carrier_frequency_Hz(load.carrier);

    // The Gauss rule of two points in each step. The many steps are for the jumps of a steered
    // array's force by up to a few per cent, where its focus is updated or its path begins again.
    const double steps = std::ceil(std::max(fewest_steps, steps_a_period * highest_Hz * end));
    const double dt_s = end / steps;
    std::vector<double> times_s;
    for (double n = 0.0; n < steps; n += 1.0)
        for (const double side : {-1.0, 1.0})
            times_s.push_back((n + 0.5 + 0.5 * side / std::numbers::sqrt3) * dt_s);
    const std::vector<double> areas_m2 = force_areas_m2(load, times_s, most_rough);
    double sum = 0.0;
    for (std::size_t n = 0; n < times_s.size(); ++n)
        sum += areas_m2[n] * amplitude(load, times_s[n]);
    return load.peak_Pa * sum * 0.5 * dt_s;
}

namespace {

double cross(Vec2 a, Vec2 b) {
    return a.x * b.y - a.y * b.x;
}

/// Signed area of the sector of the unit disc from direction a to direction b.
double sector(Vec2 a, Vec2 b) {
    return 0.5 * std::atan2(cross(a, b), dot(a, b));
}

/// Signed area shared by the unit disc about the origin and the triangle (origin, a, b): the edge
/// is split where it crosses the circle; parts inside contribute triangles, parts outside
/// contribute sectors.
double triangle_in_disc(Vec2 a, Vec2 b) {
    const Vec2 d = b - a;
    // |a + t d|^2 = 1
    const double dd = dot(d, d), ad = dot(a, d);
    const double discriminant = ad * ad - dd * (dot(a, a) - 1.0);
    if (!(discriminant > 0.0)) return sector(a, b);
    const double root = std::sqrt(discriminant);
    const double enter = (-ad - root) / dd, leave = (-ad + root) / dd;
    if (enter >= 1.0 || leave <= 0.0) return sector(a, b);
    const Vec2 first = enter > 0.0 ? a + enter * d : a;
    const Vec2 last = leave < 1.0 ? a + leave * d : b;
    double area = 0.5 * cross(first, last);
    if (enter > 0.0) area += sector(a, first);
    if (leave < 1.0) area += sector(last, b);
    return area;
}

} // namespace

double disc_fraction(double x_m, double y_m, double spacing_m, Vec2 centre, double radius_m) {
    if (!(radius_m > 0.0)) return 0.0;
    // All lengths are in units of the radius, relative to the centre of the disc.
    const double half = 0.5 * spacing_m / radius_m;
    const double x = (x_m - centre.x) / radius_m, y = (y_m - centre.y) / radius_m;
    const double near_x = std::max(0.0, std::abs(x) - half);
    const double near_y = std::max(0.0, std::abs(y) - half);
    if (near_x * near_x + near_y * near_y >= 1.0) return 0.0;
    const double far_x = std::abs(x) + half, far_y = std::abs(y) + half;
    if (far_x * far_x + far_y * far_y <= 1.0) return 1.0;

    const std::array<Vec2, 4> corner = {
        {{x - half, y - half}, {x + half, y - half}, {x + half, y + half}, {x - half, y + half}}};
    double area = 0.0;
    for (std::size_t i = 0; i < 4; ++i)
        area += triangle_in_disc(corner[i], corner[(i + 1) % 4]);
    return std::clamp(area / (4.0 * half * half), 0.0, 1.0);
}

namespace {

double squared_distance_m2(Vec2 point, Vec2 from, Vec2 to) {
    const Vec2 along = to - from, there = point - from;
    const double square = dot(along, along);
    const double part = square > 0.0 ? std::clamp(dot(there, along) / square, 0.0, 1.0) : 0.0;
    const Vec2 away = there - part * along;
    return dot(away, away);
}

/// Rows or columns of the samples between two positions, limited to the domain.
struct Cells {
    std::ptrdiff_t first, end;
};
Cells cells_between(double low_m, double high_m, double spacing_m, std::ptrdiff_t count) {
    const auto middle = static_cast<double>(count / 2), most = static_cast<double>(count);
    const double first = std::floor(low_m / spacing_m + middle);
    const double end = std::ceil(high_m / spacing_m + middle) + 1.0;
    return {static_cast<std::ptrdiff_t>(std::clamp(first, 0.0, most)),
            static_cast<std::ptrdiff_t>(std::clamp(end, 0.0, most))};
}

} // namespace

std::vector<double> shares_near(std::span<const std::vector<Vec2>> lines, double reach_m,
                                const Domain& domain) {
    const double h = domain.spacing_m, far = reach_m + h, half = 0.5 * h;
    // Squares of the distances beyond which a cell has no share, and below which it is complete.
    const double none_m2 = std::pow(reach_m + half, 2),
                 all_m2 = reach_m > half ? std::pow(reach_m - half, 2) : -1.0;
    std::vector<double> shares(static_cast<std::size_t>(domain.nx * domain.ny), 0.0);
    const auto mark = [&](Vec2 from, Vec2 to) {
        const Cells rows =
            cells_between(std::min(from.x, to.x) - far, std::max(from.x, to.x) + far, h, domain.nx);
        const Cells columns =
            cells_between(std::min(from.y, to.y) - far, std::max(from.y, to.y) + far, h, domain.ny);
        for (std::ptrdiff_t i = rows.first; i < rows.end; ++i)
            for (std::ptrdiff_t j = columns.first; j < columns.end; ++j) {
                double& share = shares[static_cast<std::size_t>(i * domain.ny + j)];
                if (share == 1.0) continue;
                const double square = squared_distance_m2({domain.x_m(i), domain.y_m(j)}, from, to);
                if (square >= none_m2) continue;
                share = square <= all_m2 ? 1.0
                                         : std::max(share, 0.5 + (reach_m - std::sqrt(square)) / h);
            }
    };
    for (const std::vector<Vec2>& line : lines)
        for (std::size_t n = 0; n < line.size(); ++n)
            mark(line[n], line[std::min(n + 1, line.size() - 1)]);
    return shares;
}

double sharpness(View2<const double> mean_u2, const Domain& domain, const Region& region,
                 std::span<const std::vector<Vec2>> lines, double reach_m) {
    assert(mean_u2.rows() == domain.nx && mean_u2.columns() == domain.ny);
    const std::vector<double> shares = shares_near(lines, reach_m, domain);
    double near = 0.0, all = 0.0;
    for (std::ptrdiff_t i = region.x0; i < region.x1; ++i)
        region.runs(i, [&](std::ptrdiff_t first, std::ptrdiff_t end, double weight) {
            for (std::ptrdiff_t j = first; j < end; ++j) {
                const double energy = weight * mean_u2(i, j);
                near += shares[static_cast<std::size_t>(i * domain.ny + j)] * energy;
                all += energy;
            }
        });
    return all > 0.0 ? near / all : not_a_number;
}

namespace {

constexpr std::size_t fewest_points = 8; // minimum number of points on one side
constexpr double start_fwhm = 3.0;       // closer to the focus, its own shape dominates
constexpr double end_fwhm = 3.0;     // end of the evaluated part: this distance from the transient,
constexpr double end_fraction = 0.8; // and at most this fraction of the distance to it
constexpr double beyond_fwhm = 4.0;  // width of the search outside the expected front
constexpr double most_residual_deg =
    4.0; // a viscosity of 1 Pa s bends the front by up to 1.4 degrees
constexpr double needed_fwhm =
    2.0; // minimum distance of the front from the border, and its minimum length

/// The frame as a smooth function of position: cubic convolution (Keys 1981), periodic.
class Surface {
public:
    Surface(View2<const double> u, const Domain& domain) : u_(u), domain_(domain) {
        const Region region = measured_region(domain);
        low_ = {domain.x_m(region.x0), domain.y_m(region.y0)};
        high_ = {domain.x_m(region.x1 - 1), domain.y_m(region.y1 - 1)};
    }

    bool measured(Vec2 p) const {
        return p.x >= low_.x && p.x <= high_.x && p.y >= low_.y && p.y <= high_.y;
    }

    double operator()(Vec2 p) const {
        const auto [i, along_x] = stencil(p.x, domain_.nx);
        const auto [j, along_y] = stencil(p.y, domain_.ny);
        double sum = 0.0;
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < 4; ++b)
                sum += along_x[a] * along_y[b] * u_(i[a], j[b]);
        return sum;
    }

private:
    struct Stencil {
        std::array<std::ptrdiff_t, 4> index;
        std::array<double, 4> weight;
    };
    Stencil stencil(double x_m, std::ptrdiff_t n) const {
        const double place = x_m / domain_.spacing_m + static_cast<double>(n / 2);
        const double cell = std::floor(place), s = place - cell;
        Stencil result;
        result.weight = {0.5 * s * (s * (2.0 - s) - 1.0), 0.5 * (s * s * (3.0 * s - 5.0) + 2.0),
                         0.5 * s * (s * (4.0 - 3.0 * s) + 1.0), 0.5 * s * s * (s - 1.0)};
        for (std::size_t a = 0; a < 4; ++a) {
            const auto i = static_cast<std::ptrdiff_t>(cell) + static_cast<std::ptrdiff_t>(a) - 1;
            result.index[a] = (i % n + n) % n;
        }
        return result;
    }

    View2<const double> u_;
    Domain domain_;
    Vec2 low_, high_;
};

/// The front `eta` to the side of the path at `xi` behind the focus.
struct FrontPoint {
    double xi = 0.0, eta = 0.0;
};

/// The region of the search, in the frame of the focus.
struct Wake {
    Vec2 focus, behind, across; // unit vectors; `across` points to the side that is searched
    double slope = 0.0;         // theoretical slope of the front, which only limits the search
    double fwhm = 0.0, from = 0.0, to = 0.0, step = 0.0;
};

/// The largest |u| along one line across the wake, if it is not at an end of the line.
std::optional<FrontPoint> front_at(const Surface& u, const Wake& wake, double xi,
                                   std::vector<double>& profile) {
    const double step = 0.5 * wake.step, reach = wake.slope * xi + beyond_fwhm * wake.fwhm;
    const Vec2 base = wake.focus + xi * wake.behind;
    profile.clear();
    for (double k = 0.0; k * step <= reach; k += 1.0) {
        const Vec2 p = base + k * step * wake.across;
        if (!u.measured(p)) break;
        profile.push_back(std::abs(u(p)));
    }
    if (static_cast<double>(profile.size()) * step < wake.slope * xi + needed_fwhm * wake.fwhm)
        return std::nullopt; // too close to the border
    const auto peak = std::max_element(profile.begin(), profile.end());
    if (peak == profile.begin() || peak + 1 == profile.end()) return std::nullopt;
    const double curvature = peak[-1] - 2.0 * peak[0] + peak[1];
    if (!(curvature < 0.0)) return std::nullopt;
    const double offset = 0.5 * (peak[-1] - peak[1]) / curvature;
    return FrontPoint{xi, (static_cast<double>(peak - profile.begin()) + offset) * step};
}

double median(std::vector<double> values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
}

double least_squares_slope(std::span<const FrontPoint> points) {
    double n = 0.0, x = 0.0, y = 0.0;
    for (const FrontPoint& p : points)
        n += 1.0, x += p.xi, y += p.eta;
    double xx = 0.0, xy = 0.0;
    for (const FrontPoint& p : points) {
        xx += (p.xi - x / n) * (p.xi - x / n);
        xy += (p.xi - x / n) * (p.eta - y / n);
    }
    return xy / xx;
}

/// Points within three robust standard deviations of the Theil-Sen line (median of the slopes of
/// all pairs, robust against up to 29 % of outliers), and that deviation.
struct StraightPart {
    std::vector<FrontPoint> points;
    double scatter = 0.0;
};
StraightPart straight_part(const std::vector<FrontPoint>& points) {
    std::vector<double> values;
    for (std::size_t i = 0; i < points.size(); ++i)
        for (std::size_t j = 0; j < i; ++j)
            values.push_back((points[i].eta - points[j].eta) / (points[i].xi - points[j].xi));
    const double slope = median(values);
    values.clear();
    for (const FrontPoint& p : points)
        values.push_back(p.eta - slope * p.xi);
    const double intercept = median(values);
    for (double& value : values)
        value = std::abs(value - intercept);

    StraightPart part;
    part.scatter = 1.4826 * median(values); // of a normal distribution
    for (std::size_t i = 0; i < points.size(); ++i)
        if (values[i] <= 3.0 * part.scatter) part.points.push_back(points[i]);
    return part;
}

MachFit without(std::string reason) {
    MachFit fit;
    fit.reason = std::move(reason);
    return fit;
}

/// Angles of the fronts on both sides, and of their halves.
struct Fronts {
    std::vector<double> angles_deg, halves_deg;
    int points = 0;
    bool crooked = false; // whether a side has no identifiable straight front
};

Fronts fronts_of(const Surface& surface, Wake wake) {
    Fronts fronts;
    std::vector<double> profile;
    for (const double side : {1.0, -1.0}) {
        wake.across = {-side * wake.behind.y, side * wake.behind.x};
        std::vector<FrontPoint> points;
        for (double xi = wake.from; xi <= wake.to; xi += wake.step)
            if (const auto point = front_at(surface, wake, xi, profile)) points.push_back(*point);
        if (points.size() < fewest_points) continue;
        const StraightPart part = straight_part(points);
        // A front that scatters by half the width of the focus is noise or another wave.
        if (part.points.size() < fewest_points || part.scatter > 0.5 * wake.fwhm) {
            fronts.crooked = true;
            continue;
        }
        fronts.angles_deg.push_back(to_degrees(std::atan(least_squares_slope(part.points))));
        const std::span<const FrontPoint> all(part.points);
        for (const auto half : {all.first(all.size() / 2), all.last(all.size() / 2)})
            fronts.halves_deg.push_back(to_degrees(std::atan(least_squares_slope(half))));
        fronts.points += static_cast<int>(part.points.size());
    }
    return fronts;
}

} // namespace

double mach_angle_theory_deg(double wave_speed_m_s, double speed_m_s) {
    if (!(speed_m_s > wave_speed_m_s)) return not_a_number;
    return to_degrees(std::asin(wave_speed_m_s / speed_m_s));
}

MachFit mach_angle(View2<const double> u, const Domain& domain, Vec2 focus_m, Vec2 velocity_m_s,
                   double rayleigh_speed_m_s, double fwhm_m, double time_since_start_s) {
    const double speed = norm(velocity_m_s);
    if (!(speed > 0.0)) return without("the focus does not move");
    if (!(speed > rayleigh_speed_m_s))
        return without(fmt::format("{:.3g} m/s is not faster than the Rayleigh wave, {:.3g} m/s",
                                   speed, rayleigh_speed_m_s));
    const double sine = rayleigh_speed_m_s / speed, cosine = std::sqrt(1.0 - sine * sine);
    const double touch = speed * time_since_start_s * cosine * cosine;
    Wake wake{.focus = focus_m,
              .behind = (-1.0 / speed) * velocity_m_s,
              .slope = sine / cosine,
              .fwhm = fwhm_m,
              .from = start_fwhm * fwhm_m,
              .to = std::min(end_fraction * touch, touch - end_fwhm * fwhm_m),
              .step = domain.spacing_m};
    if (wake.to - wake.from <
        std::max(needed_fwhm * fwhm_m, static_cast<double>(fewest_points) * domain.spacing_m))
        return without(fmt::format("the wake is too short: it is straight up to {:.3g} mm behind "
                                   "the focus, but is evaluated only from {:.3g} mm",
                                   std::max(0.0, wake.to * 1e3), wake.from * 1e3));

    const Fronts fronts = fronts_of(Surface(u, domain), wake);
    if (fronts.crooked)
        return without(
            "no Mach cone can be identified: the wake is weak, or interrupted by a modulation");
    if (fronts.angles_deg.empty()) return without("the Mach cone lies outside the measured region");

    MachFit fit;
    fit.points = fronts.points;
    fit.angle_deg = std::accumulate(fronts.angles_deg.begin(), fronts.angles_deg.end(), 0.0) /
                    static_cast<double>(fronts.angles_deg.size());
    fit.residual_deg = 0.0;
    for (const double angle : fronts.halves_deg)
        fit.residual_deg = std::max(fit.residual_deg, std::abs(angle - fit.angle_deg));
    if (fit.residual_deg > most_residual_deg)
        return without(fmt::format("the sides or parts of the Mach cone have different angles: "
                                   "they differ by {:.2g} degrees",
                                   fit.residual_deg));
    return fit;
}

} // namespace shearwake::measures
