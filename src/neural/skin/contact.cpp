// SPDX-License-Identifier: BSD-3-Clause
#include "neural/skin/contact.hpp"

#include <algorithm>
#include <cmath>
#include <Eigen/Dense>
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

} // namespace shearwake::neural
