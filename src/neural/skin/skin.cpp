// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/skin.hpp"

#include "base/units.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace shearwake::neural {
namespace {

using PinSet = std::vector<Eigen::Index>; // ascending

/// Solves for the loads of different sets of pins. Consecutive samples mostly have the same pins in
/// contact, so the last factorisation is kept.
class ContactSolver {
public:
    ContactSolver(const std::vector<Vec2>& at_mm, double radius_mm) {
        const auto pins = static_cast<Eigen::Index>(at_mm.size());
        const double compliance = (1.0 - poisson_ratio * poisson_ratio) / youngs_modulus_MPa;
        sinking_.resize(pins, pins);
        for (Eigen::Index p = 0; p < pins; ++p)
            for (Eigen::Index q = 0; q < pins; ++q) {
                const Vec2 between =
                    at_mm[static_cast<std::size_t>(p)] - at_mm[static_cast<std::size_t>(q)];
                sinking_(p, q) = compliance * sinking_profile(norm(between), radius_mm);
            }
    }

    /// Loads of the pins `pressing`, in their order, for their indentations; one column per sample.
    Eigen::MatrixXd loads(const PinSet& pressing, const Eigen::MatrixXd& indentations_mm) {
        if (pressing != factored_) {
            factors_.compute(sinking_(pressing, pressing));
            factored_ = pressing;
        }
        return factors_.solve(indentations_mm);
    }

private:
    Eigen::MatrixXd sinking_;
    PinSet factored_;
    Eigen::PartialPivLU<Eigen::MatrixXd> factors_;
};

/// Determines the pins that are displaced at a sample.
void find_moved(const Lines& s, std::size_t k, PinSet& moved) {
    moved.clear();
    for (std::size_t p = 0; p < s.count; ++p)
        if (s.line(p)[k] != 0.0) moved.push_back(static_cast<Eigen::Index>(p));
}

void put(const Eigen::VectorXd& load, const PinSet& pressing, const Lines& s, std::size_t k,
         Lines& loads) {
    for (std::size_t i = 0; i < pressing.size(); ++i) {
        const auto p = static_cast<std::size_t>(pressing[i]);
        loads.line(p)[k] = std::copysign(load[static_cast<Eigen::Index>(i)], s.line(p)[k]);
    }
}

/// Solves one sample at which some of the pins `pressing` would pull: these are released until none
/// would pull.
void let_go(ContactSolver& solver, PinSet pressing, Eigen::VectorXd load, const Lines& s,
            std::size_t k, Lines& loads) {
    while (!pressing.empty() && load.minCoeff() < 0.0) {
        PinSet remaining;
        for (std::size_t i = 0; i < pressing.size(); ++i)
            if (!(load[static_cast<Eigen::Index>(i)] < 0.0)) remaining.push_back(pressing[i]);
        pressing = std::move(remaining);
        Eigen::VectorXd indentation(static_cast<Eigen::Index>(pressing.size()));
        for (std::size_t i = 0; i < pressing.size(); ++i)
            indentation[static_cast<Eigen::Index>(i)] =
                std::abs(s.line(static_cast<std::size_t>(pressing[i]))[k]);
        if (!pressing.empty()) load = solver.loads(pressing, indentation);
    }
    put(load, pressing, s, k, loads);
}

} // namespace

double fitting_radius_mm(const std::vector<Vec2>& at_mm, double radius_mm) {
    double radius = radius_mm;
    for (std::size_t p = 0; p < at_mm.size(); ++p)
        for (std::size_t q = 0; q < p; ++q)
            radius = std::min(radius, 0.5 * norm(at_mm[p] - at_mm[q]));
    return radius;
}

double sinking_profile(double distance_mm, double radius_mm) {
    if (distance_mm <= radius_mm) return 1.0 / (2.0 * radius_mm);
    return std::asin(radius_mm / distance_mm) / (std::numbers::pi * radius_mm);
}

Lines loads_N(const PinStimulus& stimulus) {
    constexpr std::size_t most_at_once = 512; // number of columns that fit into the cache
    const Lines& s = stimulus.indentation_mm;
    Lines loads(s.count, s.samples);
    if (s.samples == 0) return loads;
    ContactSolver solver(stimulus.at_mm, stimulus.radius_mm);
    PinSet pressing, next;
    find_moved(s, 0, next);
    for (std::size_t begin = 0, end = 0; begin < s.samples; begin = end) {
        std::swap(pressing, next);
        for (end = begin + 1; end < s.samples; ++end) {
            find_moved(s, end, next);
            if (next != pressing || end - begin == most_at_once) break;
        }
        if (pressing.empty()) continue;
        Eigen::MatrixXd indentations(pressing.size(), end - begin);
        for (std::size_t i = 0; i < pressing.size(); ++i)
            for (std::size_t k = begin; k < end; ++k)
                indentations(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(k - begin)) =
                    std::abs(s.line(static_cast<std::size_t>(pressing[i]))[k]);
        const Eigen::MatrixXd all = solver.loads(pressing, indentations);
        for (std::size_t k = begin; k < end; ++k)
            let_go(solver, pressing, all.col(static_cast<Eigen::Index>(k - begin)), s, k, loads);
    }
    return loads;
}

Lines load_rates_N_s(const Lines& loads, double rate_Hz) {
    Lines rates(loads.count, loads.samples);
    const std::size_t last = loads.samples - 1;
    if (loads.samples < 2) return rates;
    for (std::size_t p = 0; p < loads.count; ++p) {
        const auto P = loads.line(p);
        const auto Q = rates.line(p);
        for (std::size_t k = 1; k < last; ++k)
            Q[k] = 0.5 * rate_Hz * (P[k + 1] - P[k - 1]);
        Q[0] = Q[1];
        Q[last] = Q[last - 1];
    }
    return rates;
}

namespace {

constexpr double never = std::numeric_limits<double>::infinity();

/// Positive if c is to the left of the line from a to b.
double turn(Vec2 a, Vec2 b, Vec2 c) {
    return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
}

/// Whether two segments cross at interior points. End points are excluded, since rounding would
/// decide on which side they are.
bool crosses(Vec2 a, Vec2 b, Vec2 c, Vec2 d) {
    if (a == c || a == d || b == c || b == d) return false;
    if (std::max(a.x, b.x) < std::min(c.x, d.x) || std::max(c.x, d.x) < std::min(a.x, b.x) ||
        std::max(a.y, b.y) < std::min(c.y, d.y) || std::max(c.y, d.y) < std::min(a.y, b.y))
        return false;
    return turn(a, b, c) * turn(a, b, d) < 0.0 && turn(c, d, a) * turn(c, d, b) < 0.0;
}

class Skin {
public:
    Skin(const Polygon& outline, std::vector<Vec2> pins)
        : outline_(outline), pins_(std::move(pins)) {
        find_corners();
        for (const Vec2 pin : pins_) {
            on_skin_.push_back(contains(outline_, pin));
            to_corners_.push_back(search(pin));
        }
    }

    std::vector<double> ways_to(Vec2 receptor) const {
        std::vector<double> paths(pins_.size(), never);
        if (!contains(outline_, receptor)) return paths;
        std::vector<double> from_corner(corners_.size(), never);
        for (std::size_t c = 0; c < corners_.size(); ++c)
            if (sees(corners_[c], receptor)) from_corner[c] = norm(receptor - corners_[c]);
        for (std::size_t p = 0; p < pins_.size(); ++p) {
            if (!on_skin_[p]) continue;
            if (sees(pins_[p], receptor)) {
                paths[p] = norm(receptor - pins_[p]);
                continue;
            }
            for (std::size_t c = 0; c < corners_.size(); ++c)
                paths[p] = std::min(paths[p], to_corners_[p][c] + from_corner[c]);
        }
        return paths;
    }

private:
    void find_corners() {
        double twice_area = 0.0;
        const std::size_t n = outline_.size();
        for (std::size_t i = 0; i < n; ++i)
            twice_area += turn({}, outline_[i], outline_[(i + 1) % n]);
        for (std::size_t i = 0; i < n; ++i)
            if (turn(outline_[(i + n - 1) % n], outline_[i], outline_[(i + 1) % n]) * twice_area <
                0.0)
                corners_.push_back(outline_[i]);
        for (const Vec2 a : corners_) {
            std::vector<double>& row = between_.emplace_back();
            for (const Vec2 b : corners_)
                row.push_back(a == b || is_side(a, b) || corners_see(a, b) ? norm(b - a) : never);
        }
    }

    bool is_side(Vec2 a, Vec2 b) const {
        const std::size_t n = outline_.size();
        for (std::size_t i = 0; i < n; ++i) {
            const Vec2 c = outline_[i], d = outline_[(i + 1) % n];
            if ((a == c && b == d) || (a == d && b == c)) return true;
        }
        return false;
    }

    /// Whether the straight line from or to a point on the skin stays on the skin, that is, crosses
    /// no side of the outline.
    bool sees(Vec2 a, Vec2 b) const {
        const std::size_t n = outline_.size();
        for (std::size_t i = 0, before = n - 1; i < n; before = i++)
            if (crosses(a, b, outline_[before], outline_[i])) return false;
        return true;
    }
    /// The same test for two corners, whose connection may also lie in a gap.
    bool corners_see(Vec2 a, Vec2 b) const {
        return sees(a, b) && contains(outline_, 0.5 * (a + b));
    }

    /// Shortest paths from a pin to every corner by Dijkstra's algorithm.
    std::vector<double> search(Vec2 pin) const {
        std::vector<double> length(corners_.size(), never);
        if (!contains(outline_, pin)) return length;
        for (std::size_t c = 0; c < corners_.size(); ++c)
            if (sees(pin, corners_[c])) length[c] = norm(corners_[c] - pin);
        std::vector<bool> settled(corners_.size(), false);
        for (std::size_t round = 0; round < corners_.size(); ++round) {
            std::size_t nearest = corners_.size();
            for (std::size_t c = 0; c < corners_.size(); ++c)
                if (!settled[c] && (nearest == corners_.size() || length[c] < length[nearest]))
                    nearest = c;
            settled[nearest] = true;
            for (std::size_t c = 0; c < corners_.size(); ++c)
                length[c] = std::min(length[c], length[nearest] + between_[nearest][c]);
        }
        return length;
    }

    Polygon outline_;
    std::vector<Vec2> pins_, corners_;
    std::vector<std::vector<double>> between_; // for each pair of corners
    std::vector<bool> on_skin_;                // for each pin
    std::vector<std::vector<double>> to_corners_;
};

} // namespace

SkinPaths straight_paths(std::vector<Vec2> pins_mm) {
    return [pins = std::move(pins_mm)](Vec2 receptor_mm) {
        std::vector<double> paths;
        for (const Vec2 pin : pins)
            paths.push_back(norm(receptor_mm - pin));
        return paths;
    };
}

SkinPaths paths_within(const Polygon& outline_mm, std::vector<Vec2> pins_mm) {
    const auto skin = std::make_shared<const Skin>(outline_mm, std::move(pins_mm));
    return [skin](Vec2 receptor_mm) { return skin->ways_to(receptor_mm); };
}

double stress_per_load(double distance_mm, double depth_mm, double radius_mm) {
    const double xi = depth_mm / radius_mm, rho = distance_mm / radius_mm;
    const double q = rho * rho + xi * xi - 1.0;
    const double R = std::sqrt(q * q + 4.0 * xi * xi);
    const double phi = std::atan2(2.0 * xi, q), theta = std::atan(1.0 / xi);
    const double J01 = std::sin(0.5 * phi) / std::sqrt(R);
    const double J02 = std::sqrt(1.0 + xi * xi) * std::sin(1.5 * phi - theta) / (R * std::sqrt(R));
    return (J01 + xi * J02) / (two_pi * radius_mm * radius_mm);
}

std::size_t arrival_samples(double distance_mm, double radius_mm, double rate_Hz) {
    const double path_mm = std::max(distance_mm - radius_mm, 0.0);
    const double samples = std::nearbyint(path_mm / wave_speed_mm_s * rate_Hz);
    if (!(samples < 1e15)) return std::numeric_limits<std::size_t>::max(); // the wave never arrives
    return static_cast<std::size_t>(samples);
}

double wave_gain(double distance_mm, double depth_mm, double radius_mm) {
    if (!std::isfinite(distance_mm)) return 0.0;
    return sinking_profile(distance_mm, radius_mm) / (depth_mm * depth_mm);
}

} // namespace shearwake::neural
