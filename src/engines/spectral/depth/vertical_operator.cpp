// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/depth/vertical_operator.hpp"

#include "base/error.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <iterator>

namespace shearwake::spectral {

namespace {

double viscosity_of(const Layer& layer) {
    if (const auto viscosity_Pa_s = newtonian_viscosity_Pa_s(layer.loss)) return *viscosity_Pa_s;
    throw CaseFailure("engine \"spectral\" supports only Kelvin-Voigt and lossless layers");
}

double lambda_of(const Layer& layer) {
    return layer.density_kg_m3 * layer.c_p_m_s * layer.c_p_m_s - 2.0 * static_shear_modulus(layer);
}

} // namespace

Background background_of(const DepthMesh& mesh, const Medium& medium) {
    Background b;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const Layer& layer = medium.layers[mesh.layers[e]];
        for (int i = 0; i <= mesh.degree; ++i) {
            b.density_kg_m3.push_back(layer.density_kg_m3);
            b.lambda_Pa.push_back(implicit_lambda_Pa(lambda_of(layer)));
            b.mu_accurate_Pa.push_back(static_shear_modulus(layer));
            b.mu_stable_Pa.push_back(static_shear_modulus(layer));
            b.mu_greatest_Pa.push_back(static_shear_modulus(layer));
            b.viscosity_Pa_s.push_back(viscosity_of(layer));
            const double into_m =
                mesh.z_m(e * static_cast<std::size_t>(mesh.degree) + static_cast<std::size_t>(i)) -
                mesh.clear_depth_m();
            b.swirl_viscosity_Pa_s.push_back(mesh.bottom && into_m > 0.0
                                                 ? swirl_viscosity_Pa_s(*mesh.bottom, layer, into_m)
                                                 : 0.0);
            b.force_lambda_Pa.push_back(lambda_of(layer));
        }
        b.theta_s.push_back(viscosity_of(layer) / static_shear_modulus(layer));
    }
    return b;
}

VerticalOperator::VerticalOperator(const DepthMesh& mesh, Background background)
    : background_(std::move(background)), finest_(finest_mode(mesh.rule)),
      derivative_(mesh.rule.derivative), weights_(mesh.rule.weights), nodes_(mesh.degree + 1),
      levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)),
      assembly_(simd::kernels<AssemblyKernels>()), kernels_(simd::kernels<VerticalKernels>()),
      solver_(simd::kernels<SkylineKernels>()), psv_matrix_(levels_, mesh.degree, 2),
      sh_matrix_(levels_, mesh.degree, 1) {
    if (mesh.bottom) {
        const std::size_t last = point(mesh.elements() - 1, nodes_ - 1);
        termination_ =
            Termination{background_.density_kg_m3[last],
                        background_.force_lambda_Pa[last] + 2.0 * background_.mu_accurate_Pa[last]};
    }
    if (nodes_ > most_nodes)
        throw CaseFailure("solver.spectral.degree must be at most " +
                          std::to_string(most_nodes - 1));
    mass_.assign(mesh.levels(), 0.0);
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double half = 0.5 * mesh.length_m(e);
        VerticalElement el{.slope = 1.0 / half,
                           .half = half,
                           .density = background_.density_kg_m3[point(e, 0)],
                           .lambda_Pa = background_.lambda_Pa[point(e, 0)],
                           .theta_s = background_.theta_s[e],
                           .absorbs = false};
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            const std::size_t at = point(e, i);
            const auto level =
                e * static_cast<std::size_t>(nodes_ - 1) + static_cast<std::size_t>(i);
            const double mass =
                background_.density_kg_m3[at] * half * weights_[static_cast<std::size_t>(i)];
            mass_[level] += mass;
            el.absorbs |= background_.swirl_viscosity_Pa_s[at] > 0.0;
            el.density = std::min(el.density, background_.density_kg_m3[at]);
            el.lambda_Pa = std::min(el.lambda_Pa, background_.lambda_Pa[at]);
        }
        if (mesh.has_light_body(e)) el.density = 0.0;
        elements_.push_back(el);
    }
}

double VerticalOperator::stabilised_mu_Pa(std::size_t element, double mu_Pa, double k_rad_m,
                                          double dt_s) const {
    const VerticalElement& el = elements_[element];
    const double stabilised_Pa =
        stabilised_modulus_Pa(k_rad_m * k_rad_m, finest_ * el.slope * el.slope,
                              stable_share * el.density / (dt_s * dt_s), el.lambda_Pa);
    return std::max(mu_Pa / 12.0, mu_Pa / 4.0 - stabilised_Pa);
}

VerticalArrays VerticalOperator::arrays() const {
    const Background& b = background_;
    return {.nodes = nodes_,
            .levels = levels_,
            .elements = std::ssize(elements_),
            .element = elements_.data(),
            .derivative = derivative_.data(),
            .weights = weights_.data(),
            .mass_kg_m2 = mass_.data(),
            .finest = finest_,
            .lambda_Pa = b.lambda_Pa.data(),
            .mu_accurate_Pa = b.mu_accurate_Pa.data(),
            .mu_stable_Pa = b.mu_stable_Pa.data(),
            .mu_greatest_Pa = b.mu_greatest_Pa.data(),
            .viscosity_Pa_s = b.viscosity_Pa_s.data(),
            .swirl_viscosity_Pa_s = b.swirl_viscosity_Pa_s.data(),
            .force_lambda_Pa = b.force_lambda_Pa.data(),
            .termination = termination_ ? &*termination_ : nullptr,
            .psv = psv_matrix_.rows(),
            .sh = sh_matrix_.rows()};
}

void VerticalOperator::factorise(Operator which, const Block& k, double dt_s, Block* factor) const {
    Block* sh = factor + psv_matrix_.entries();
    assembly_.assemble_psv(arrays(), which, k, dt_s, factor);
    assembly_.assemble_sh(arrays(), which, k, dt_s, sh);
    solver_.factorise(psv_matrix_.rows(), factor);
    solver_.factorise(sh_matrix_.rows(), sh);
}

void VerticalOperator::solve_implicit(const Block* factor, Block* pencil) const {
    solver_.solve(psv_matrix_.rows(), factor, pencil);
    solver_.solve(sh_matrix_.rows(), factor + psv_matrix_.entries(), pencil + psv() * parts);
}

Block VerticalOperator::implicit_form(const Block* factor, Block* pencil,
                                      const Block* counted) const {
    Block form = solver_.quadratic_form(psv_matrix_.rows(), factor, pencil, counted);
    add_scaled(1.0,
               solver_.quadratic_form(sh_matrix_.rows(), factor + psv_matrix_.entries(),
                                      pencil + psv() * parts, counted),
               form);
    return form;
}

Block VerticalOperator::twice_kinetic(double rate, const Block* u, const Block* before,
                                      const Block* counted) const {
    return kernels_.twice_kinetic(arrays(), rate, u, before, counted);
}

void VerticalOperator::add_internal_force(const Block& k, double rate, const Block* u,
                                          const Block* before, Block* force,
                                          const Block* factor) const {
    kernels_.add_internal_force(arrays(), k, rate, u, before, force,
                                {factor, factor ? factor_size() : 0});
}

SkylineMatrix::SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree,
                             std::ptrdiff_t per_level) {
    for (std::ptrdiff_t level = 0; level < levels; ++level) {
        const std::ptrdiff_t element = std::max<std::ptrdiff_t>(level - 1, 0) / degree;
        for (std::ptrdiff_t i = 0; i < per_level; ++i) {
            const std::ptrdiff_t first = element * degree * per_level;
            rows_.push_back({first, entries_ - first});
            entries_ += level * per_level + i - first + 1;
        }
    }
}

} // namespace shearwake::spectral
