#include "engines/spectral/vertical_operator.hpp"

#include "base/error.hpp"
#include "engines/spectral/skyline_matrix.hpp"

#include <algorithm>

namespace shearwake {
namespace {

constexpr std::ptrdiff_t most_nodes = 17;
double viscosity_of(const Layer& layer) {
    if (std::holds_alternative<Lossless>(layer.loss)) return 0.0;
    if (const auto* law = std::get_if<KelvinVoigt>(&layer.loss)) return law->viscosity_Pa_s;
    throw CaseFailure("engine spectral computes Kelvin-Voigt or lossless layers");
}

double lambda_of(const Layer& layer) {
    return layer.density_kg_m3 * layer.c_p_m_s * layer.c_p_m_s - 2.0 * static_shear_modulus(layer);
}

/// The largest eigenvalue of unit shear stiffness against unit mass on an element, for motion that
/// keeps its volume (W' = k U; the rest is lambda's): `vertical` is that of slopes. Plane waves
/// have k^2 + vertical; at an element's ends, of which its finest modes live, up to twice that.
auto greatest_stiffness(const auto& k2, double vertical) {
    return k2 + vertical + 4.0 * vertical * k2 / (k2 + vertical);
}

/// out[q][column] = sum over j of D[q][j] in[j][column], or with D transposed; rows of `width`.
enum class Matrix { as_is, transposed };
template <int width>
void times_derivative(const double* derivative, std::ptrdiff_t nodes, Matrix which, const Lanes* in,
                      Lanes* out) {
    const std::ptrdiff_t along = which == Matrix::as_is ? 1 : nodes;
    const std::ptrdiff_t across = which == Matrix::as_is ? nodes : 1;
    for (std::ptrdiff_t q = 0; q < nodes; ++q) {
        Lanes sum[width] = {};
        for (std::ptrdiff_t j = 0; j < nodes; ++j) {
            const double d = derivative[q * across + j * along];
            for (int c = 0; c < width; ++c)
                sum[c] += d * in[j * width + c];
        }
        for (int c = 0; c < width; ++c)
            out[q * width + c] = sum[c];
    }
}

} // namespace

Background background_of(const DepthMesh& mesh, const Medium& medium) {
    Background b;
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const Layer& layer = medium.layers[mesh.layers[e]];
        for (int i = 0; i <= mesh.degree; ++i) {
            b.density_kg_m3.push_back(layer.density_kg_m3);
            b.lambda_Pa.push_back(lambda_of(layer));
            b.mu_accurate_Pa.push_back(static_shear_modulus(layer));
            b.mu_stable_Pa.push_back(static_shear_modulus(layer));
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
      levels_(static_cast<std::ptrdiff_t>(mesh.levels() - 1)), psv_matrix_(levels_, mesh.degree, 2),
      sh_matrix_(levels_, mesh.degree, 1) {
    if (nodes_ > most_nodes) throw CaseFailure("solver.spectral.degree is too high");
    mass_.assign(mesh.levels(), 0.0);
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const double half = 0.5 * mesh.length_m(e);
        Element el{1.0 / half, half, background_.density_kg_m3[point(e, 0)], false};
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            const std::size_t at = point(e, i);
            const auto level =
                e * static_cast<std::size_t>(nodes_ - 1) + static_cast<std::size_t>(i);
            const double mass =
                background_.density_kg_m3[at] * half * weights_[static_cast<std::size_t>(i)];
            mass_[level] += mass;
            el.absorbs |= background_.swirl_viscosity_Pa_s[at] > 0.0;
            el.density = std::min(el.density, background_.density_kg_m3[at]);
        }
        elements_.push_back(el);
    }
}

double VerticalOperator::stabilised_mu_Pa(std::size_t element, double mu_Pa, double k_rad_m,
                                          double dt_s) const {
    const Element& el = elements_[element];
    const double kappa2 = greatest_stiffness(k_rad_m * k_rad_m, finest_ * el.slope * el.slope);
    return std::max(mu_Pa / 12.0, mu_Pa / 4.0 - 0.98 * el.density / (kappa2 * dt_s * dt_s));
}

Lanes VerticalOperator::implicit_mu(std::size_t element, std::ptrdiff_t node, Lanes k,
                                    double dt_s) const {
    const Element& el = elements_[element];
    const std::size_t at = point(element, node);
    const Lanes kappa2 = greatest_stiffness(k * k, finest_ * el.slope * el.slope);
    Lanes m;
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane)
        m[lane] = std::max(background_.mu_accurate_Pa[at] / 12.0,
                           background_.mu_stable_Pa[at] / 4.0 -
                               0.98 * el.density / (kappa2[lane] * dt_s * dt_s));
    return m;
}

void VerticalOperator::assemble_psv(Lanes k, double dt_s, Lanes* matrix) const {
    std::fill_n(matrix, psv_matrix_.entries(), Lanes{});
    const auto add = [&](std::ptrdiff_t row, std::ptrdiff_t column, Lanes value) {
        if (column <= row && row < psv()) psv_matrix_.at(matrix, row, column) += value;
    };
    for (std::ptrdiff_t i = 0; i < psv(); ++i) {
        const auto level = static_cast<std::size_t>(i / 2);
        add(i, i, Lanes{} + mass_[level] / (dt_s * dt_s));
    }
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        const std::ptrdiff_t first = 2 * static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        Lanes lw[most_nodes], mw[most_nodes], sw[most_nodes]; // moduli times the nodes' weights
        for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
            const double w = weights_[static_cast<std::size_t>(q)] * el.half;
            lw[q] = Lanes{} + w * stabilising_lambda * background_.lambda_Pa[point(e, q)];
            mw[q] = w * (implicit_mu(e, q, k, dt_s) +
                         0.5 * background_.viscosity_Pa_s[point(e, q)] / dt_s);
            sw[q] = Lanes{} + w * 0.5 * background_.swirl_viscosity_Pa_s[point(e, q)] / dt_s;
        }
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            for (std::ptrdiff_t j = 0; j < nodes_; ++j) {
                Lanes l_slopes{}, m_slopes{}, s_slopes{}; // integrals of the two nodes' derivatives
                for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
                    const double dd = d(q, i) * d(q, j) * el.slope * el.slope;
                    l_slopes += lw[q] * dd;
                    m_slopes += mw[q] * dd;
                    s_slopes += sw[q] * dd;
                }
                const std::ptrdiff_t ui = first + 2 * i, uj = first + 2 * j;
                Lanes uu = m_slopes + s_slopes, ww = l_slopes + 2.0 * m_slopes;
                if (i == j) {
                    uu += k * k * (lw[i] + 2.0 * mw[i]);
                    ww += k * k * (mw[i] + sw[i]);
                }
                // Test function V_i against W_j: -lambda k V W' + mu V' k W - swirl V' k W.
                const Lanes uw = k * el.slope * ((mw[j] - sw[j]) * d(j, i) - lw[i] * d(i, j));
                const Lanes wu = k * el.slope * ((mw[i] - sw[i]) * d(i, j) - lw[j] * d(j, i));
                add(ui, uj, uu);
                add(ui + 1, uj + 1, ww);
                add(ui, uj + 1, uw);
                add(ui + 1, uj, wu);
            }
        }
    }
}

void VerticalOperator::assemble_sh(Lanes k, double dt_s, Lanes* matrix) const {
    std::fill_n(matrix, sh_matrix_.entries(), Lanes{});
    const auto add = [&](std::ptrdiff_t row, std::ptrdiff_t column, Lanes value) {
        if (column <= row && row < levels_) sh_matrix_.at(matrix, row, column) += value;
    };
    for (std::ptrdiff_t i = 0; i < levels_; ++i) {
        const auto level = static_cast<std::size_t>(i);
        add(i, i, Lanes{} + mass_[level] / (dt_s * dt_s));
    }
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
            const double w = weights_[static_cast<std::size_t>(q)] * el.half;
            const double viscosity = background_.viscosity_Pa_s[point(e, q)] +
                                     background_.swirl_viscosity_Pa_s[point(e, q)];
            const Lanes mw = w * (implicit_mu(e, q, k, dt_s) + 0.5 * viscosity / dt_s);
            add(first + q, first + q, k * k * mw);
            for (std::ptrdiff_t i = 0; i < nodes_; ++i)
                for (std::ptrdiff_t j = 0; j <= i; ++j)
                    add(first + i, first + j, mw * (d(q, i) * d(q, j) * el.slope * el.slope));
        }
    }
}

void VerticalOperator::factorise_implicit(Lanes k, double dt_s, Lanes* factor) const {
    assemble_psv(k, dt_s, factor);
    psv_matrix_.factorise(factor);
    Lanes* sh = factor + psv_matrix_.entries();
    assemble_sh(k, dt_s, sh);
    sh_matrix_.factorise(sh);
}

void VerticalOperator::solve_implicit(const Lanes* factor, Lanes* pencil) const {
    psv_matrix_.solve(factor, pencil);
    sh_matrix_.solve(factor + psv_matrix_.entries(), pencil + psv() * parts);
}

Lanes VerticalOperator::implicit_form(const Lanes* factor, Lanes* pencil,
                                      const Lanes* counted) const {
    return psv_matrix_.quadratic_form(factor, pencil, counted) +
           sh_matrix_.quadratic_form(factor + psv_matrix_.entries(), pencil + psv() * parts,
                                     counted);
}

Lanes VerticalOperator::twice_kinetic(double rate, const Lanes* u, const Lanes* before,
                                      const Lanes* counted) const {
    Lanes all{};
    const auto add = [&](std::ptrdiff_t unknown, double mass) {
        for (std::ptrdiff_t p = 0; p < parts; ++p) {
            const Lanes v = rate * (u[unknown * parts + p] - before[unknown * parts + p]);
            all += mass * counted[p] * v * v;
        }
    };
    for (std::ptrdiff_t level = 0; level < levels_; ++level) {
        const double mass = mass_[static_cast<std::size_t>(level)];
        add(2 * level, mass);
        add(2 * level + 1, mass);
        add(psv() + level, mass);
    }
    return all;
}

void VerticalOperator::add_internal_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                                          Lanes* force) const {
    constexpr int fields = 4; // mu-weighted U, W, V; then W alone
    constexpr int wide = fields * parts, narrow = 3 * parts;
    Lanes at_nodes[most_nodes * wide], slopes[most_nodes * wide];
    Lanes pulls[most_nodes * narrow], pushed[most_nodes * narrow];
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        const double theta = background_.theta_s[e] * rate; // mu (u + theta (u - before))
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            Lanes* x = at_nodes + i * wide;
            if (first + i >= levels_) { // the base
                std::fill_n(x, wide, Lanes{});
                continue;
            }
            const std::ptrdiff_t uw = 2 * (first + i) * parts, v = (psv() + first + i) * parts;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Lanes a = u[uw + p], b = u[uw + parts + p], c = u[v + p];
                x[p] = a + theta * (a - before[uw + p]);
                x[parts + p] = b + theta * (b - before[uw + parts + p]);
                x[2 * parts + p] = c + theta * (c - before[v + p]);
                x[3 * parts + p] = b;
            }
        }
        times_derivative<wide>(derivative_.data(), nodes_, Matrix::as_is, at_nodes, slopes);
        for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
            const double w = weights_[static_cast<std::size_t>(q)] * el.half;
            const double wl = w * background_.force_lambda_Pa[point(e, q)];
            const double wm = w * background_.mu_accurate_Pa[point(e, q)];
            const Lanes* x = at_nodes + q * wide;
            const Lanes* s = slopes + q * wide;
            Lanes* pull = pulls + q * narrow;
            const bool rests = first + q >= levels_;
            const std::ptrdiff_t uw = 2 * (first + q) * parts, v = (psv() + first + q) * parts;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Lanes plain_u = rests ? Lanes{} : u[uw + p];
                const Lanes dilation = wl * (el.slope * s[3 * parts + p] - k * plain_u);
                const Lanes shear = wm * (el.slope * s[p] + k * x[parts + p]);
                pull[p] = shear * el.slope;
                pull[parts + p] = (dilation + 2.0 * wm * el.slope * s[parts + p]) * el.slope;
                pull[2 * parts + p] = (wm * el.slope * el.slope) * s[2 * parts + p];
                if (rests) continue;
                force[uw + p] -= k * (2.0 * wm * k * x[p] - dilation);
                force[uw + parts + p] -= k * shear;
                force[v + p] -= wm * k * k * x[2 * parts + p];
            }
        }
        times_derivative<narrow>(derivative_.data(), nodes_, Matrix::transposed, pulls, pushed);
        for (std::ptrdiff_t i = 0; i < nodes_ && first + i < levels_; ++i) {
            const std::ptrdiff_t uw = 2 * (first + i) * parts, v = (psv() + first + i) * parts;
            for (std::ptrdiff_t p = 0; p < 2 * parts; ++p)
                force[uw + p] -= pushed[i * narrow + p];
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                force[v + p] -= pushed[i * narrow + 2 * parts + p];
        }
    }
    add_swirl_force(k, rate, u, before, force);
}

void VerticalOperator::add_swirl_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                                       Lanes* force) const {
    constexpr int width = 3 * parts; // U, W, V
    Lanes speeds[most_nodes * width], slopes[most_nodes * width];
    Lanes pulls[most_nodes * width], pushed[most_nodes * width];
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        if (!el.absorbs) continue;
        const std::ptrdiff_t first = static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        std::fill_n(speeds, nodes_ * width, Lanes{});
        for (std::ptrdiff_t i = 0; i < nodes_ && first + i < levels_; ++i) {
            const std::ptrdiff_t uw = 2 * (first + i) * parts, v = (psv() + first + i) * parts;
            for (std::ptrdiff_t p = 0; p < 2 * parts; ++p)
                speeds[i * width + p] = rate * (u[uw + p] - before[uw + p]);
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                speeds[i * width + 2 * parts + p] = rate * (u[v + p] - before[v + p]);
        }
        times_derivative<width>(derivative_.data(), nodes_, Matrix::as_is, speeds, slopes);
        std::fill_n(pulls, nodes_ * width, Lanes{});
        for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
            const double w = weights_[static_cast<std::size_t>(q)] * el.half *
                             background_.swirl_viscosity_Pa_s[point(e, q)];
            const Lanes *x = speeds + q * width, *s = slopes + q * width;
            const std::ptrdiff_t uw = 2 * (first + q) * parts, v = (psv() + first + q) * parts;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                const Lanes swirl = w * (el.slope * s[p] - k * x[parts + p]);
                pulls[q * width + p] = el.slope * swirl;
                pulls[q * width + 2 * parts + p] = w * el.slope * el.slope * s[2 * parts + p];
                if (first + q >= levels_) continue; // the base
                force[uw + parts + p] += k * swirl;
                force[v + p] -= w * k * k * x[2 * parts + p];
            }
        }
        times_derivative<width>(derivative_.data(), nodes_, Matrix::transposed, pulls, pushed);
        for (std::ptrdiff_t i = 0; i < nodes_ && first + i < levels_; ++i) {
            const std::ptrdiff_t uw = 2 * (first + i) * parts, v = (psv() + first + i) * parts;
            for (std::ptrdiff_t p = 0; p < parts; ++p) {
                force[uw + p] -= pushed[i * width + p];
                force[v + p] -= pushed[i * width + 2 * parts + p];
            }
        }
    }
}

} // namespace shearwake
