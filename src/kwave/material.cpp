// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "engines/pstd/scene/case_step.hpp"
#include "kwave/reader.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace shearwake::kwave {
namespace {

using pstd::Node;

/// The material of a slab, to which the functions of Setup refer.
struct Material {
    NodeValues lambda, mu, chi, eta;
    std::array<NodeValues, 3> rho, mu_sg, eta_sg;
    std::ptrdiff_t x0 = 0, x1 = 0;
    bool lossy = false;
};

void check_values(const std::string& name, const NodeValues& field, const char* must,
                  const auto& is_valid) {
    const auto bad = std::find_if_not(field.values.begin(), field.values.end(), is_valid);
    if (bad == field.values.end()) return;
    const auto at = static_cast<std::ptrdiff_t>(bad - field.values.begin());
    const std::string where =
        field.values.size() == 1
            ? std::string()
            : fmt::format(" at index ({}, {}, {})", at % field.nx + field.x0 + 1,
                          at / field.nx % field.ny + 1, at / field.nx / field.ny + 1);
    throw UsageError(fmt::format("{} is {}{}; it must be {}", name, *bad, where, must));
}

/// Limits of the step, and numbers of nodes and faces for warnings.
void survey(const Material& m, const pstd::Slabs& slabs, Input& input) {
    // The step is certainly unstable above the limit of a node with the largest of its densities.
    StepLimits& limits = input.limits;
    limits.alone_s = limits.density_kg_m3 = std::numeric_limits<double>::infinity();
    const double spacing_m = pstd::cubic_spacing_m(input.setup.grid);
    pstd::NodeMaterial last; // most neighbours are equal
    std::pair<double, double> last_densities;
    for (std::ptrdiff_t x = m.x0; x < m.x0 + slabs.x_count(); ++x)
        for (std::ptrdiff_t y = 0; y < slabs.ny(); ++y)
            for (std::ptrdiff_t z = 0; z < slabs.nz(); ++z) {
                const Node n{x, y, z};
                const pstd::NodeMaterial here = input.setup.material(n);
                if (3.0 * m.lambda(n) + 2.0 * m.mu(n) < 0.0) input.soft_nodes += 1.0;
                for (const Node next : {Node{x + 1, y, z}, Node{x, y + 1, z}, Node{x, y, z + 1}})
                    if (next[0] < slabs.nx() && next[1] < slabs.ny() && next[2] < slabs.nz() &&
                        (m.mu(n) == 0.0) != (m.mu(next) == 0.0))
                        input.fluid_faces += 1.0;
                const auto densities = std::minmax({m.rho[0](n), m.rho[1](n), m.rho[2](n)});
                if (here == last && densities == last_densities) continue;
                last = here;
                last_densities = densities;
                const auto [low, high] = densities;
                const double modulus = m.lambda(n) + 2.0 * m.mu(n);
                if (!(modulus > 0.0))
                    throw UsageError(fmt::format("lambda + 2 mu is {} at index ({}, {}, {}); it "
                                                 "must be positive",
                                                 modulus, x + 1, y + 1, z + 1));
                const pstd::NodeMaterial heaviest{high, std::sqrt(modulus / high),
                                                  std::sqrt(m.mu(n) / high), here.chi_Pa_s,
                                                  here.eta_Pa_s};
                limits.alone_s =
                    std::min(limits.alone_s, pstd::largest_step_s(heaviest, spacing_m));
                limits.density_kg_m3 = std::min(limits.density_kg_m3, low);
                limits.p_modulus_Pa = std::max(limits.p_modulus_Pa, modulus);
                limits.p_viscosity_Pa_s =
                    std::max(limits.p_viscosity_Pa_s, here.chi_Pa_s + 2.0 * here.eta_Pa_s);
            }
}

} // namespace

void Reader::read_material() {
    auto material = std::make_shared<Material>();
    Material& m = *material;
    m.lossy = flag("absorbing_flag", 1) == 1;
    m.x0 = slabs_.x_start();
    m.x1 = std::min(m.x0 + slabs_.x_count() + 1, slabs_.nx());
    const auto positive = [](float value) { return value > 0.0f; };
    const auto not_negative = [](float value) { return value >= 0.0f; };
    const auto moduli = [&](const std::string& name) {
        NodeValues values = field(name);
        check_values(name, values, "0 or more", not_negative);
        return values;
    };
    m.lambda = field("lambda");
    m.mu = moduli("mu");
    for (std::size_t i = 0; i < 3; ++i) {
        const std::string name = fmt::format("rho0_sg{}", axes[i]);
        m.rho[i] = field(name);
        check_values(name, m.rho[i], "positive", positive);
        m.mu_sg[i] = moduli(fmt::format("mu_sg{}", planes[i]));
    }
    if (m.lossy) {
        m.chi = field("chi");
        m.eta = moduli("eta");
        for (std::size_t i = 0; i < 3; ++i)
            m.eta_sg[i] = moduli(fmt::format("eta_sg{}", planes[i]));
    }
    auto& setup = input_.setup;
    setup.absorption = m.lossy ? pstd::Absorption::kelvin_voigt : pstd::Absorption::none;
    setup.material = [material](Node n) {
        const Material& of = *material;
        if (n[0] < of.x0 || n[0] >= of.x1) return pstd::NodeMaterial{}; // of another rank
        const double rho = of.rho[0](n), mu = of.mu(n);
        return pstd::NodeMaterial{.density_kg_m3 = rho,
                                  .c_p_m_s = std::sqrt((of.lambda(n) + 2.0 * mu) / rho),
                                  .c_s_m_s = std::sqrt(mu / rho),
                                  .chi_Pa_s = of.lossy ? of.chi(n) : 0.0,
                                  .eta_Pa_s = of.lossy ? of.eta(n) : 0.0};
    };
    pstd::StaggeredMaterial& staggered = setup.staggered.emplace();
    for (std::size_t i = 0; i < 3; ++i) {
        staggered.density_kg_m3[i] = [=](Node n) { return material->rho[i](n); };
        staggered.mu_Pa[i] = [=](Node n) { return material->mu_sg[i](n); };
        staggered.eta_Pa_s[i] = [=](Node n) { return material->eta_sg[i](n); };
    }
    survey(m, slabs_, input_);
}

} // namespace shearwake::kwave
