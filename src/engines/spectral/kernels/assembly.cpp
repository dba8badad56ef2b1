// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/slices.hpp"
#include "engines/spectral/kernels/vertical.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// Assembles a slice of the matrices of one block of wavenumbers.
struct Assembly {
    const VerticalArrays& v;
    SkylineRows rows;
    Block* matrix;
    std::ptrdiff_t slice;

    /// Adds to an entry of the lower triangle if the row belongs to a moving level.
    [[gnu::always_inline]] void add(std::ptrdiff_t row, std::ptrdiff_t column, Vector value) const {
        if (column > row || row >= rows.count) return;
        Block& entry = matrix[rows.row[row].start + column];
        set(entry, slice, get(entry, slice) + value);
    }
    double d(std::ptrdiff_t q, std::ptrdiff_t i) const { return v.derivative[q * v.nodes + i]; }
};

/// The modulus that the inertia of an element stabilises.
[[gnu::always_inline]] inline Vector
stabilised_modulus(const VerticalArrays& v, const VerticalElement& e, Vector k, double dt_s) {
    const double vertical = v.finest * e.slope * e.slope;
    const double inertia = stable_share * e.density / (dt_s * dt_s);
    Vector stabilised{};
    for (std::ptrdiff_t i = 0; i < width; ++i)
        stabilised[i] = stabilised_modulus_Pa(k[i] * k[i], vertical, inertia, e.lambda_Pa);
    return stabilised;
}

/// max(mu_accurate/12, mu_stable/4 - stabilised) and half of the viscosity per step, or for the
/// energy max(mu_accurate/12 - mu_greatest/4, -stabilised).
[[gnu::always_inline]] inline Vector shear_modulus(const VerticalArrays& v, Operator which,
                                                   std::ptrdiff_t at, Vector stabilised,
                                                   double viscous_Pa) {
    const double accurate_Pa = v.mu_accurate_Pa[at] / 12.0;
    if (which == Operator::of_change)
        return simd::greater(simd::all_lanes(accurate_Pa - 0.25 * v.mu_greatest_Pa[at]),
                             -stabilised);
    return simd::greater(simd::all_lanes(accurate_Pa), 0.25 * v.mu_stable_Pa[at] - stabilised) +
           viscous_Pa;
}

double share_of_lambda(Operator which) {
    return which == Operator::implicit ? stabilising_lambda : stabilising_lambda - 0.25;
}

void clear(SkylineRows rows, Block* matrix) {
    const SkylineRow& last = rows.row[rows.count - 1];
    for (std::ptrdiff_t i = 0; i < last.start + rows.count; ++i)
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            set(matrix[i], s, Vector{});
}

/// Moduli times the quadrature weights of the nodes.
struct ElementModuli {
    Vector lambda[most_nodes], mu[most_nodes], swirl[most_nodes];
};

void add_psv_pair(const Assembly& a, std::ptrdiff_t first, double slope, Vector k,
                  const ElementModuli& m, std::ptrdiff_t i, std::ptrdiff_t j) {
    Vector l_slopes{}, m_slopes{}, s_slopes{}; // integrals of products of two nodal derivatives
    for (std::ptrdiff_t q = 0; q < a.v.nodes; ++q) {
        const double dd = a.d(q, i) * a.d(q, j) * slope * slope;
        l_slopes += m.lambda[q] * dd;
        m_slopes += m.mu[q] * dd;
        s_slopes += m.swirl[q] * dd;
    }
    const std::ptrdiff_t ui = first + 2 * i, uj = first + 2 * j;
    Vector uu = m_slopes + s_slopes, ww = l_slopes + 2.0 * m_slopes;
    if (i == j) {
        uu += k * k * (m.lambda[i] + 2.0 * m.mu[i]);
        ww += k * k * (m.mu[i] + m.swirl[i]);
    }
    // Test function V_i and W_j: -lambda k V W' + mu V' k W - swirl V' k W.
    const Vector uw = k * slope * ((m.mu[j] - m.swirl[j]) * a.d(j, i) - m.lambda[i] * a.d(i, j));
    const Vector wu = k * slope * ((m.mu[i] - m.swirl[i]) * a.d(i, j) - m.lambda[j] * a.d(j, i));
    a.add(ui, uj, uu);
    a.add(ui + 1, uj + 1, ww);
    a.add(ui, uj + 1, uw);
    a.add(ui + 1, uj, wu);
}

void add_termination(const Assembly& a, Operator which, Vector k, double dt_s) {
    const Termination& end = *a.v.termination;
    const double rate = which == Operator::implicit ? 0.5 / dt_s : 0.0;
    const Vector stiffness = share_of_lambda(which) * end.modulus_Pa * k, scale = root(k);
    const Vector dashpot =
        simd::all_lanes(rate * std::sqrt(end.density_kg_m3 * end.modulus_Pa)); // rho c_p
    const std::ptrdiff_t w = a.rows.count - 3;
    a.add(w, w, dashpot);
    for (std::ptrdiff_t i = 0; i < oscillators; ++i) {
        const std::ptrdiff_t y = w + 1 + i;
        const Oscillator& o = oscillator[i];
        a.add(w, w, stiffness * (o.spring * o.lever * o.lever));
        a.add(y, w, scale * (dashpot * o.share - stiffness * (o.spring * o.lever)));
        a.add(y, y, end.density_kg_m3 / (dt_s * dt_s) + scale * scale * stiffness * o.spring);
        for (std::ptrdiff_t j = 0; j <= i; ++j)
            a.add(y, w + 1 + j, scale * scale * dashpot * (o.share * oscillator[j].share));
    }
}

void assemble_psv(const VerticalArrays& v, Operator which, const Block& k8, double dt_s,
                  Block* matrix) {
    clear(v.psv, matrix);
    // Viscosity only takes energy away.
    const double rate = which == Operator::implicit ? 0.5 / dt_s : 0.0;
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Assembly a{v, v.psv, matrix, s};
        const Vector k = get(k8, s);
        for (std::ptrdiff_t i = 0; i < v.psv.count; ++i)
            a.add(i, i, simd::all_lanes(v.mass_kg_m2[i / 2] / (dt_s * dt_s)));
        for (std::ptrdiff_t e = 0; e < v.elements; ++e) {
            const VerticalElement& el = v.element[e];
            const Vector stabilised = stabilised_modulus(v, el, k, dt_s);
            ElementModuli m;
            for (std::ptrdiff_t q = 0; q < v.nodes; ++q) {
                const std::ptrdiff_t at = e * v.nodes + q;
                const double w = v.weights[q] * el.half;
                m.lambda[q] = simd::all_lanes(w * share_of_lambda(which) * v.lambda_Pa[at]);
                m.mu[q] = w * shear_modulus(v, which, at, stabilised, rate * v.viscosity_Pa_s[at]);
                m.swirl[q] = simd::all_lanes(w * rate * v.swirl_viscosity_Pa_s[at]);
            }
            for (std::ptrdiff_t i = 0; i < v.nodes; ++i)
                for (std::ptrdiff_t j = 0; j <= i; ++j)
                    add_psv_pair(a, 2 * e * (v.nodes - 1), el.slope, k, m, i, j);
        }
        if (v.termination) add_termination(a, which, k, dt_s);
    }
}

void assemble_sh(const VerticalArrays& v, Operator which, const Block& k8, double dt_s,
                 Block* matrix) {
    clear(v.sh, matrix);
    const double rate = which == Operator::implicit ? 0.5 / dt_s : 0.0;
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        const Assembly a{v, v.sh, matrix, s};
        const Vector k = get(k8, s);
        for (std::ptrdiff_t i = 0; i < v.sh.count; ++i)
            a.add(i, i, simd::all_lanes(v.mass_kg_m2[i] / (dt_s * dt_s)));
        if (v.termination) // its level has no unknown here, and the matrix has to be regular
            a.add(v.sh.count - 1, v.sh.count - 1,
                  simd::all_lanes(v.termination->density_kg_m3 / (dt_s * dt_s)));
        for (std::ptrdiff_t e = 0; e < v.elements; ++e) {
            const VerticalElement& el = v.element[e];
            const std::ptrdiff_t first = e * (v.nodes - 1);
            const Vector stabilised = stabilised_modulus(v, el, k, dt_s);
            for (std::ptrdiff_t q = 0; q < v.nodes; ++q) {
                const std::ptrdiff_t at = e * v.nodes + q;
                const double w = v.weights[q] * el.half;
                const double viscosity = v.viscosity_Pa_s[at] + v.swirl_viscosity_Pa_s[at];
                const Vector mw = w * shear_modulus(v, which, at, stabilised, rate * viscosity);
                a.add(first + q, first + q, k * k * mw);
                for (std::ptrdiff_t i = 0; i < v.nodes; ++i)
                    for (std::ptrdiff_t j = 0; j <= i; ++j)
                        a.add(first + i, first + j,
                              mw * (a.d(q, i) * a.d(q, j) * el.slope * el.slope));
            }
        }
    }
}

constexpr AssemblyKernels table = {assemble_psv, assemble_sh};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::AssemblyKernels&
shearwake::simd::compiled<shearwake::spectral::AssemblyKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
