#include "engines/spectral/vertical_operator.hpp"

#include "base/error.hpp"

#include <algorithm>

namespace shearwake {
namespace {

constexpr std::ptrdiff_t most_nodes = 17;
/// Compressional motion is far faster than any step: a quarter makes it unconditionally stable, the
/// little more keeps what it couples to so as well.
constexpr double stabilising_lambda = 0.26;

double viscosity_of(const Layer& layer) {
    if (std::holds_alternative<Lossless>(layer.loss)) return 0.0;
    if (const auto* law = std::get_if<KelvinVoigt>(&layer.loss)) return law->viscosity_Pa_s;
    throw CaseFailure("engine spectral computes Kelvin-Voigt or lossless layers");
}

} // namespace

VerticalOperator::VerticalOperator(const DepthMesh& mesh, const Medium& medium)
    : finest_(finest_mode(mesh.rule)), derivative_(mesh.rule.derivative),
      weights_(mesh.rule.weights), nodes_(mesh.degree + 1),
      unknowns_(2 * static_cast<std::ptrdiff_t>(mesh.levels() - 1)) {
    if (medium.base != Base::rigid) throw CaseFailure("engine spectral needs a rigid base");
    if (nodes_ > most_nodes) throw CaseFailure("solver.spectral.degree is too high");
    mass_.assign(static_cast<std::size_t>(unknowns_) + 2, 0.0);
    for (std::size_t e = 0; e < mesh.elements(); ++e) {
        const Layer& layer = medium.layers[mesh.layers[e]];
        const double mu = static_shear_modulus(layer);
        const double half = 0.5 * mesh.length_m(e);
        elements_.push_back({layer.density_kg_m3,
                             layer.density_kg_m3 * layer.c_p_m_s * layer.c_p_m_s - 2.0 * mu, mu,
                             viscosity_of(layer), 1.0 / half, half});
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            const auto level = static_cast<std::ptrdiff_t>(e) * (nodes_ - 1) + i;
            for (std::ptrdiff_t c = 0; c < 2; ++c)
                mass_[static_cast<std::size_t>(2 * level + c)] +=
                    layer.density_kg_m3 * half * weights_[static_cast<std::size_t>(i)];
        }
    }
    mass_.resize(static_cast<std::size_t>(unknowns_));
}

Lanes VerticalOperator::stabilising_mu(const Element& el, Lanes k, double dt_s) const {
    const double vertical = finest_ * el.slope * el.slope;
    Lanes a;
    for (std::ptrdiff_t lane = 0; lane < lane_count; ++lane) {
        const double fastest = el.mu / el.density * (k[lane] * k[lane] + vertical); // (rad/s)^2
        a[lane] = std::max(1.0 / 12.0, 0.25 - 0.98 / (fastest * dt_s * dt_s));
    }
    return a;
}

void VerticalOperator::assemble(Lanes k, double dt_s, Lanes* matrix) const {
    for (std::ptrdiff_t i = 0; i < unknowns_ * band(); ++i)
        matrix[i] = Lanes{};
    const auto add = [&](std::ptrdiff_t row, std::ptrdiff_t column, Lanes value) {
        if (column <= row && row < unknowns_)
            matrix[row * band() + column - row + band() - 1] += value;
    };
    for (std::ptrdiff_t i = 0; i < unknowns_; ++i)
        add(i, i, Lanes{} + mass_[static_cast<std::size_t>(i)] / (dt_s * dt_s));
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        const double l = stabilising_lambda * el.lambda;
        const Lanes m = stabilising_mu(el, k, dt_s) * el.mu + 0.5 * el.eta / dt_s;
        const std::ptrdiff_t first = 2 * static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        const auto d = [&](std::ptrdiff_t q, std::ptrdiff_t i) {
            return derivative_[static_cast<std::size_t>(q * nodes_ + i)] * el.slope;
        };
        for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
            for (std::ptrdiff_t j = 0; j < nodes_; ++j) {
                double slopes = 0.0; // integral of the two nodes' derivatives
                for (std::ptrdiff_t q = 0; q < nodes_; ++q)
                    slopes += weights_[static_cast<std::size_t>(q)] * el.half * d(q, i) * d(q, j);
                const double wi = weights_[static_cast<std::size_t>(i)] * el.half;
                const double wj = weights_[static_cast<std::size_t>(j)] * el.half;
                const std::ptrdiff_t ui = first + 2 * i, uj = first + 2 * j;
                Lanes uu = m * slopes, ww = (l + 2.0 * m) * slopes;
                if (i == j) {
                    uu += k * k * ((l + 2.0 * m) * wi);
                    ww += k * k * (m * wi);
                }
                // Test function V_i against W_j: -lambda k V W' + mu V' k W.
                const Lanes uw = k * (-l * wi * d(i, j) + m * wj * d(j, i));
                const Lanes wu = k * (-l * wj * d(j, i) + m * wi * d(i, j));
                add(ui, uj, uu);
                add(ui + 1, uj + 1, ww);
                add(ui, uj + 1, uw);
                add(ui + 1, uj, wu);
            }
        }
    }
}

void VerticalOperator::add_internal_force(Lanes k, double rate, const Lanes* u, const Lanes* before,
                                          Lanes* force) const {
    Lanes div_u[most_nodes], div_w[most_nodes], shear_u[most_nodes], shear_w[most_nodes];
    Lanes dw[most_nodes], du_m[most_nodes], dw_m[most_nodes], s[most_nodes], g[most_nodes],
        r[most_nodes];
    for (std::size_t e = 0; e < elements_.size(); ++e) {
        const Element& el = elements_[e];
        const std::ptrdiff_t first = 2 * static_cast<std::ptrdiff_t>(e) * (nodes_ - 1);
        for (std::ptrdiff_t part = 0; part < parts; ++part) {
            for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
                const auto n = static_cast<std::size_t>(i);
                const std::ptrdiff_t at = (first + 2 * i) * parts + part;
                if (first + 2 * i >= unknowns_) { // the base
                    div_u[n] = div_w[n] = shear_u[n] = shear_w[n] = Lanes{};
                    continue;
                }
                const Lanes a = u[at], b = u[at + parts];
                div_u[n] = el.lambda * a;
                div_w[n] = el.lambda * b;
                shear_u[n] = el.mu * a + el.eta * rate * (a - before[at]);
                shear_w[n] = el.mu * b + el.eta * rate * (b - before[at + parts]);
            }
            for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
                const auto n = static_cast<std::size_t>(q);
                Lanes lw{}, mu_u{}, mu_w{};
                for (std::ptrdiff_t j = 0; j < nodes_; ++j) {
                    const auto c = static_cast<std::size_t>(j);
                    const double d = derivative_[static_cast<std::size_t>(q * nodes_ + j)];
                    lw += d * div_w[c];
                    mu_u += d * shear_u[c];
                    mu_w += d * shear_w[c];
                }
                dw[n] = lw * el.slope;
                du_m[n] = mu_u * el.slope;
                dw_m[n] = mu_w * el.slope;
                const double w = weights_[n] * el.half;
                s[n] = w * (dw[n] - k * div_u[n]);      // lambda (W' - kU)
                g[n] = w * (du_m[n] + k * shear_w[n]);  // mu (U' + kW)
                dw_m[n] = s[n] + 2.0 * w * dw_m[n];     // sigma_zz
                r[n] = 2.0 * w * k * shear_u[n] - s[n]; // -sigma_rr
            }
            for (std::ptrdiff_t i = 0; i < nodes_; ++i) {
                if (first + 2 * i >= unknowns_) continue;
                const auto n = static_cast<std::size_t>(i);
                const Lanes fu = k * r[n], fw = k * g[n];
                Lanes su{}, sw{};
                for (std::ptrdiff_t q = 0; q < nodes_; ++q) {
                    const double d = derivative_[static_cast<std::size_t>(q * nodes_ + i)];
                    su += d * g[static_cast<std::size_t>(q)];
                    sw += d * dw_m[static_cast<std::size_t>(q)];
                }
                const std::ptrdiff_t at = (first + 2 * i) * parts + part;
                force[at] -= fu + su * el.slope;
                force[at + parts] -= fw + sw * el.slope;
            }
        }
    }
}

void factorise(std::ptrdiff_t unknowns, std::ptrdiff_t band, Lanes* matrix) {
    // row(i)[j] is the entry (i, j).
    const auto row = [&](std::ptrdiff_t i) { return matrix + i * band + (band - 1 - i); };
    for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
        Lanes* mine = row(i);
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        for (std::ptrdiff_t j = first; j < i; ++j) { // L_ij D_j
            const Lanes* other = row(j);
            Lanes sum = mine[j];
            const std::ptrdiff_t common = std::max(first, j - band + 1);
            for (std::ptrdiff_t m = common; m < j; ++m)
                sum -= mine[m] * other[m];
            mine[j] = sum;
        }
        Lanes diagonal = mine[i];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = mine[j] * row(j)[j]; // the diagonal holds 1 / D
            diagonal -= l * mine[j];
            mine[j] = l;
        }
        mine[i] = 1.0 / diagonal;
    }
}

void solve(std::ptrdiff_t unknowns, std::ptrdiff_t band, const Lanes* factor, Lanes* x) {
    for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        const Lanes* row = factor + i * band + band - 1 - i;
        Lanes a = x[i * parts], b = x[i * parts + 1], c = x[i * parts + 2], d = x[i * parts + 3];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = row[j];
            a -= l * x[j * parts];
            b -= l * x[j * parts + 1];
            c -= l * x[j * parts + 2];
            d -= l * x[j * parts + 3];
        }
        x[i * parts] = a;
        x[i * parts + 1] = b;
        x[i * parts + 2] = c;
        x[i * parts + 3] = d;
    }
    for (std::ptrdiff_t i = 0; i < unknowns; ++i)
        for (std::ptrdiff_t part = 0; part < parts; ++part)
            x[i * parts + part] *= factor[i * band + band - 1];
    for (std::ptrdiff_t i = unknowns; i-- > 0;) {
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        const Lanes* row = factor + i * band + band - 1 - i;
        const Lanes a = x[i * parts], b = x[i * parts + 1], c = x[i * parts + 2],
                    d = x[i * parts + 3];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = row[j];
            x[j * parts] -= l * a;
            x[j * parts + 1] -= l * b;
            x[j * parts + 2] -= l * c;
            x[j * parts + 3] -= l * d;
        }
    }
}

} // namespace shearwake
