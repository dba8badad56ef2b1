// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/coefficients.hpp"

#include "engines/pstd/scheme/placed_source.hpp"
#include "parallel/agree.hpp"

#include <algorithm>

namespace shearwake::pstd {
namespace {

KnownNodes nodes_of(const Setup& setup, const Slabs& slabs, const Comm& team) {
    std::optional<KnownNodes> nodes;
    together(team, [&] { nodes.emplace(slabs, setup.material); });
    return std::move(*nodes);
}

} // namespace

Preparation::Preparation(const Setup& setup, const Slabs& slabs, const Comm& team)
    : nodes(nodes_of(setup, slabs, team)), reference_m_s(setup.pml.reference_speed_m_s) {
    if (reference_m_s == 0.0) reference_m_s = team.max(nodes.largest_c_p_m_s());
    top = static_cast<std::ptrdiff_t>(team.min(static_cast<double>(nodes.top())));
}

double device_memory_B(const Setup& setup, double value_B, double coefficients,
                       double source_nodes) {
    const Slabs slabs = slabs_of(setup.grid, 1, 0);
    // Fields, gradients and accelerations; zeros for an axis with one point.
    double arrays = coefficients + (setup.absorption != Absorption::none ? 18.0 : 12.0) +
                    (std::ranges::count(setup.grid.points, 1) > 0 ? 1.0 : 0.0);
    double bytes = arrays * static_cast<double>(slabs.reals()) * value_B;
    for (std::size_t f = 0; f < field_count; ++f) {
        const SplitSizes split = split_sizes(slabs, setup.pml, parts_of(static_cast<Field>(f)));
        bytes += split.values * value_B + split.runs_B;
    }
    // Of a node of a source also a factor, a sum, the last value, and samples.
    const double samples =
        static_cast<double>(samples_at_once(static_cast<std::size_t>(source_nodes)));
    return bytes + source_nodes * (sizeof(PlacedSource<double>::Place) + 2.0 * sizeof(double) +
                                   (1.0 + samples) * value_B);
}

std::vector<Node> split_nodes(Field field, const Slabs& slabs, const std::vector<Source>& sources) {
    std::vector<Node> nodes;
    for (const Source& s : sources)
        if (s.field == field && s.mode == SourceMode::dirichlet && is_velocity(field))
            std::copy_if(s.nodes.begin(), s.nodes.end(), std::back_inserter(nodes),
                         [&](const Node& n) { return slabs.has(n[0]); });
    return nodes;
}

template <class Real>
Coefficients<Real>::Coefficients(const Setup& setup, const Preparation& prepared,
                                 const Slabs& slabs, const Comm& team) {
    const Grid& grid = slabs.grid;
    const MaterialOfNode& material = prepared.material;
    const double dt_s = grid.dt_s;
    using Value = std::function<double(Node)>;
    const auto coefficient = [&](const Value& value) {
        return Coefficient<Real>(slabs, team, value);
    };
    constexpr std::array<std::array<std::size_t, 2>, 3> planes{
        {{0, 1}, {0, 2}, {1, 2}}}; // of sxy, sxz, syz
    const Value mu = [&](Node n) { return material(n).mu_Pa(); };
    const Value viscosity = [&](Node n) { return material(n).eta_Pa_s; };
    StaggeredMaterial staggered;
    if (setup.staggered) staggered = *setup.staggered;
    const auto unless_given = [](Value& given, const Value& mean) {
        if (!given) given = mean;
    };
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t a = planes[i][0], b = planes[i][1];
        unless_given(staggered.density_kg_m3[i],
                     [&, i](Node n) { return density_between(grid, material, n, i); });
        unless_given(staggered.mu_Pa[i],
                     [&, a, b](Node n) { return harmonic_between(grid, mu, n, a, b); });
        unless_given(staggered.eta_Pa_s[i],
                     [&, a, b](Node n) { return harmonic_between(grid, viscosity, n, a, b); });
    }
    for (std::size_t i = 0; i < 3; ++i) {
        dt_over_rho[i] = coefficient([&](Node n) { return dt_s / staggered.density_kg_m3[i](n); });
        dt_mu[i] = coefficient([&](Node n) { return dt_s * staggered.mu_Pa[i](n); });
    }
    dt_lambda = coefficient([&](Node n) { return dt_s * material(n).lambda_Pa(); });
    dt_p_modulus = coefficient(
        [&](Node n) { return dt_s * (material(n).lambda_Pa() + 2.0 * material(n).mu_Pa()); });
    if (setup.absorption == Absorption::none) return;
    chi = coefficient([&](Node n) { return material(n).chi_Pa_s; });
    chi_2eta =
        coefficient([&](Node n) { return material(n).chi_Pa_s + 2.0 * material(n).eta_Pa_s; });
    for (std::size_t i = 0; i < 3; ++i)
        eta[i] = coefficient(staggered.eta_Pa_s[i]);
}

template struct Coefficients<double>;
template struct Coefficients<float>;

} // namespace shearwake::pstd
