// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/stress/static_response.hpp"

#include <algorithm>
#include <cmath>

namespace shearwake::spectral {
namespace {

/// A depth within this distance of an element boundary, relative to the element's length, belongs
/// to both elements.
constexpr double rounding = 1e-9;

LongMesh long_mesh(const DepthMesh& mesh, const std::vector<double>& force_m, double reach_m,
                   const std::vector<double>& outer_m) {
    const auto [least, most] = std::minmax_element(force_m.begin(), force_m.end());
    const double low_m = *least - reach_m, high_m = *most + reach_m;
    LongMesh all{mesh, 0.0};
    std::vector<double> ends_m;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        if (mesh.ends_m[e + 1] < low_m || mesh.ends_m[e] > high_m) continue;
        if (ends_m.empty()) ends_m.push_back(mesh.ends_m[e]);
        ends_m.push_back(mesh.ends_m[e + 1]);
    }
    for (const double length_m : outer_m) {
        ends_m.insert(ends_m.begin(), ends_m.front() - length_m);
        ends_m.push_back(ends_m.back() + length_m);
    }
    all.top_m = ends_m.front();
    for (double& end_m : ends_m)
        end_m -= all.top_m;
    all.mesh.ends_m = ends_m;
    all.mesh.layers.assign(ends_m.size() - 1, 0);
    all.mesh.light.clear();
    all.mesh.bottom.reset();
    return all;
}

/// The static operator K of a solid with mu = 1 as the implicit operator of a step of 1 s, with its
/// weights.
VerticalOperator static_operator(const DepthMesh& mesh, double lambda_per_mu) {
    const std::size_t points = mesh.elements() * mesh.rule.nodes.size();
    const auto all = [&](double value) { return std::vector<double>(points, value); };
    return {mesh,
            {.density_kg_m3 = all(0.0),
             .lambda_Pa = all(lambda_per_mu / stabilising_lambda),
             .mu_accurate_Pa = all(12.0),
             .mu_stable_Pa = all(0.0),
             .viscosity_Pa_s = all(0.0),
             .mu_greatest_Pa = all(1.0),
             .swirl_viscosity_Pa_s = all(0.0),
             .force_lambda_Pa = all(lambda_per_mu),
             .theta_s = std::vector<double>(mesh.elements(), 0.0)}};
}

std::vector<double> slope_of(const std::vector<double>& weights, const DepthMesh& mesh,
                             double length_m) {
    const std::size_t nodes = weights.size();
    std::vector<double> slope(nodes, 0.0);
    for (std::size_t q = 0; q < nodes; ++q)
        for (std::size_t j = 0; j < nodes; ++j)
            slope[j] += 2.0 / length_m * weights[q] * mesh.rule.derivative[q * nodes + j];
    return slope;
}

std::vector<NodeWeights> places(const DepthMesh& mesh, double depth_m) {
    std::vector<NodeWeights> all;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double length_m = mesh.length_m(e), margin_m = rounding * length_m;
        if (depth_m < mesh.ends_m[e] - margin_m || depth_m > mesh.ends_m[e + 1] + margin_m)
            continue;
        const double x = 2.0 * (depth_m - mesh.ends_m[e]) / length_m - 1.0;
        NodeWeights p{.first = static_cast<std::ptrdiff_t>(e) * mesh.degree,
                      .share = 1.0,
                      .value = interpolation_weights(mesh.rule, x),
                      .slope = {},
                      .smooth = smoothing_weights(mesh.rule, x),
                      .smooth_slope = {}};
        p.slope = slope_of(p.value, mesh, length_m);
        p.smooth_slope = slope_of(p.smooth, mesh, length_m);
        all.push_back(std::move(p));
    }
    for (NodeWeights& p : all)
        p.share = 1.0 / static_cast<double>(all.size());
    return all;
}

/// Unit forces along and across the wave vector (part 0) and along z (part 1).
void put_forces(const NodeWeights& at, std::ptrdiff_t levels, fft::AlignedVector<Block>& pencil) {
    std::fill(pencil.begin(), pencil.end(), Block{});
    for (std::size_t j = 0; j < at.value.size(); ++j) {
        const std::ptrdiff_t level = at.first + static_cast<std::ptrdiff_t>(j);
        if (level >= levels) continue; // the last level does not move
        for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
            pencil[static_cast<std::size_t>(2 * level * parts)][lane] = at.value[j];
            pencil[static_cast<std::size_t>((2 * levels + level) * parts)][lane] = at.value[j];
            pencil[static_cast<std::size_t>((2 * level + 1) * parts + 1)][lane] = at.value[j];
        }
    }
}

/// The response of one lane to put_forces().
struct Lane {
    const Block* pencil;
    std::ptrdiff_t levels, lane;
    double k_rad_m, lambda_per_mu;

    /// The sum of weights times U or W (`unknown` 0 or 1) in a part, or times V (2).
    double sum(const NodeWeights& at, const std::vector<double>& weights, std::ptrdiff_t unknown,
               std::ptrdiff_t part) const {
        double sum = 0.0;
        for (std::size_t j = 0; j < weights.size(); ++j) {
            const std::ptrdiff_t level = at.first + static_cast<std::ptrdiff_t>(j);
            if (level >= levels) continue;
            const std::ptrdiff_t row = unknown < 2 ? 2 * level + unknown : 2 * levels + level;
            sum += weights[j] * pencil[row * parts + part][lane];
        }
        return sum;
    }
    RadialStress stress(const std::vector<NodeWeights>& places) const {
        RadialStress f{};
        for (const NodeWeights& at : places) {
            for (std::ptrdiff_t part = 0; part < 2; ++part) {
                const double pressure = lambda_per_mu * (sum(at, at.smooth_slope, 1, part) -
                                                         k_rad_m * sum(at, at.smooth, 0, part));
                auto& to = part == 0 ? f.along_r : f.along_z;
                to.rr += at.share * (pressure - 2.0 * k_rad_m * sum(at, at.value, 0, part));
                to.tt += at.share * pressure;
                to.zz += at.share * (pressure + 2.0 * sum(at, at.slope, 1, part));
                to.rz +=
                    at.share * (sum(at, at.slope, 0, part) + k_rad_m * sum(at, at.value, 1, part));
            }
            f.rt -= at.share * k_rad_m * sum(at, at.value, 2, 0);
            f.tz += at.share * sum(at, at.slope, 2, 0);
        }
        return f;
    }
};

/// The mean stress of the plane at a height below the force, of which half acts on either side.
RadialStress mean_stress(double below_m, double lambda_per_mu) {
    const double half = below_m > 0.0 ? -0.5 : below_m < 0.0 ? 0.5 : 0.0;
    const double across = half * lambda_per_mu / (lambda_per_mu + 2.0);
    return {.along_r = {0.0, 0.0, 0.0, half},
            .along_z = {across, across, half, 0.0},
            .rt = 0.0,
            .tz = half};
}

} // namespace

StaticResponse::StaticResponse(const DepthMesh& mesh, double lambda_per_mu,
                               std::vector<double> force_m, std::vector<double> stress_m,
                               double reach_m, const std::vector<double>& outer_m)
    : lambda_per_mu_(lambda_per_mu), reach_m_(reach_m), force_m_(std::move(force_m)),
      stress_m_(std::move(stress_m)), mesh_(long_mesh(mesh, force_m_, reach_m, outer_m)),
      operator_(static_operator(mesh_.mesh, lambda_per_mu)),
      factor_(static_cast<std::size_t>(operator_.factor_size())),
      pencil_(static_cast<std::size_t>(operator_.unknowns() * parts)) {
    for (const double depth_m : force_m_)
        force_at_.push_back(places(mesh_.mesh, depth_m - mesh_.top_m).front());
    for (const double depth_m : stress_m_)
        stress_at_.push_back(places(mesh_.mesh, depth_m - mesh_.top_m));
}

void StaticResponse::each(const Block& k_rad_m, std::ptrdiff_t lanes, const Use& use) {
    operator_.factorise_implicit(k_rad_m, 1.0, factor_.data());
    for (std::size_t d = 0; d < force_m_.size(); ++d) {
        put_forces(force_at_[d], operator_.levels(), pencil_);
        operator_.solve_implicit(factor_.data(), pencil_.data());
        for (std::size_t s = 0; s < stress_m_.size(); ++s) {
            const double below_m = stress_m_[s] - force_m_[d];
            if (std::abs(below_m) > reach_m_) continue;
            for (std::ptrdiff_t lane = 0; lane < lanes; ++lane) {
                const Lane one{pencil_.data(), operator_.levels(), lane, k_rad_m[lane],
                               lambda_per_mu_};
                use(s, d, lane,
                    k_rad_m[lane] > 0.0 ? one.stress(stress_at_[s])
                                        : mean_stress(below_m, lambda_per_mu_));
            }
        }
    }
}

} // namespace shearwake::spectral
