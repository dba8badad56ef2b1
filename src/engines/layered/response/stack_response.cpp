// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/stack_response.hpp"

#include "base/error.hpp"
#include "base/units.hpp"
#include "engines/layered/response/gauss_rule.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;
using State = Eigen::Matrix<Complex, 4, 1>; // U, W, sigma_zz / S, (sigma_rz / i) / S
using Pair = Eigen::Matrix<Complex, 4, 2>;
using Square2 = Eigen::Matrix<Complex, 2, 2>;

/// Stands for k = 0, where a wavelength is 6000 km.
constexpr double least_k_rad_m = 1e-6;

/// e^z - 1 without cancellation for small z.
Complex exp_minus_one(Complex z) {
    const double half_sine = std::sin(0.5 * z.imag());
    return {std::expm1(z.real()) * std::cos(z.imag()) - 2.0 * half_sine * half_sine,
            std::exp(z.real()) * std::sin(z.imag())};
}

/// The two solutions of one layer that decay (or radiate) with the distance zeta from a point. The
/// first one is the compressional wave with coefficient A of docs/explanation/engine-layered.md.
/// The second one combines shear (C) and compressional waves, k [ (alpha/k) C - A ] / (alpha -
/// beta), which stays finite and independent of the first one as alpha -> beta.
template <class Wavenumber>
class LayerModes {
public:
    LayerModes(Wavenumber k, Complex mu, Complex kp2, Complex ks2, Complex ratio,
               double stress_scale)
        : k_(k), mu_(mu / stress_scale), ks2_(ks2) {
        const Wavenumber k2 = k * k;
        alpha_ = std::sqrt(k2 - kp2);
        beta_ = std::sqrt(k2 - ks2);
        const Complex sum = alpha_ + beta_;
        difference_ = (ks2 - kp2) / sum;                               // alpha - beta
        s_ = sum / (1.0 - ratio);                                      // ks2 / (alpha - beta)
        q_ = -(k2 * (1.0 + ratio) - kp2) * s_ / (k2 + alpha_ * beta_); // (alpha beta - k2)/(a-b)
    }

    /// Solutions that decay downward from z = 0.
    Pair down(double zeta) const {
        const Complex e_alpha = std::exp(-alpha_ * zeta);
        const Complex e_beta = std::exp(-beta_ * zeta);
        const Wavenumber k2 = k_ * k_;
        const Complex phi = spread(zeta, e_alpha, e_beta);
        Pair s;
        s(0, 0) = k_ * e_alpha;
        s(1, 0) = -alpha_ * e_alpha;
        s(2, 0) = mu_ * (2.0 * k2 - ks2_) * e_alpha;
        s(3, 0) = -2.0 * mu_ * k_ * alpha_ * e_alpha;
        s(0, 1) = q_ * e_beta + k2 * phi;
        s(1, 1) = -alpha_ * k_ * phi;
        s(2, 1) = mu_ * k_ * (2.0 * q_ * e_beta + 2.0 * k2 * phi + s_ * e_alpha);
        s(3, 1) = mu_ * alpha_ * (s_ * e_beta - 2.0 * k2 * phi);
        return s;
    }

    /// The mirror image: solutions that decay upward.
    Pair up(double zeta) const { return mirrored(down(zeta)); }

    static Pair mirrored(Pair s) {
        s.row(1) = -s.row(1);
        s.row(3) = -s.row(3);
        return s;
    }

    Complex alpha() const { return alpha_; }
    Complex beta() const { return beta_; }
    /// The factors of e^{-alpha zeta} in down(), and those of e^{-beta zeta}. They cancel for k
    /// much larger than k_s: digits of (k / k_s)^4 are lost in products.
    Pair alpha_factors() const {
        const Complex share = k_ * k_ / difference_;
        Pair s = down(0.0);
        s.col(1) << -share, alpha_ * k_ / difference_, mu_ * k_ * (s_ - 2.0 * share),
            mu_ * alpha_ * 2.0 * share;
        return s;
    }
    Pair beta_factors() const {
        Pair s = Pair::Zero();
        s.col(1) = down(0.0).col(1) - alpha_factors().col(1);
        return s;
    }

private:
    /// (e^{-beta zeta} - e^{-alpha zeta}) / (alpha - beta).
    Complex spread(double zeta, Complex e_alpha, Complex e_beta) const {
        const Complex x = difference_ * zeta;
        if (std::norm(x) > 0.25) return (e_beta - e_alpha) / difference_;
        if (x == 0.0) return zeta * e_beta;
        return -e_beta * exp_minus_one(-x) / difference_;
    }

    Wavenumber k_;
    Complex mu_, ks2_, alpha_, beta_, difference_, s_, q_;
};

/// Continuation of the solution below a layer through that layer: for given downgoing amplitudes,
/// the upgoing amplitudes and the amplitudes of the admissible states at its bottom.
struct Continuation {
    Square2 up, below;
};

using Amplitudes = Eigen::Matrix<Complex, 2, 1>;

/// The solution within one layer.
struct InLayer {
    std::size_t layer = 0;
    double scale = 1.0; // of the stresses
    State surface;      // of the uppermost layer
    Amplitudes down, up = Amplitudes::Zero();
    bool radiates = false; // a half-space, without `up`
};

/// The larger of the magnitudes of both parts: a norm without a root.
double magnitude(Complex z) {
    return std::max(std::abs(z.real()), std::abs(z.imag()));
}

/// Solves for both right sides by elimination with column scaling and partial pivoting, without
/// Eigen's LU decomposition, which calls routines for matrices of any size.
Continuation solve_bottom(const Pair& up_at_bottom, const Pair& down_at_bottom, const Pair& below) {
    Eigen::Matrix<Complex, 4, 6> a;
    a << up_at_bottom, -below, -down_at_bottom;
    Eigen::Array4d scales;
    for (int column = 0; column < 4; ++column) {
        double largest = 0.0;
        for (int row = 0; row < 4; ++row)
            largest = std::max(largest, magnitude(a(row, column)));
        scales[column] = 1.0 / largest;
        a.col(column) *= scales[column];
    }
    for (int step = 0; step < 4; ++step) {
        int pivot = step;
        for (int row = step + 1; row < 4; ++row)
            if (magnitude(a(row, step)) > magnitude(a(pivot, step))) pivot = row;
        if (pivot != step) a.row(pivot).swap(a.row(step));
        a.row(step).tail(5 - step) *= std::conj(a(step, step)) / std::norm(a(step, step));
        for (int row = 0; row < 4; ++row) {
            const Complex factor = row == step ? Complex() : a(row, step);
            for (int column = step + 1; column < 6; ++column)
                a(row, column) -= factor * a(step, column);
        }
    }
    a.array().colwise() *= scales.cast<Complex>();
    return {a.topRightCorner<2, 2>(), a.bottomRightCorner<2, 2>()};
}

using Strains = Eigen::Matrix<Complex, 3, 1>;

/// The strains k U, W' and (U' + k W) / sqrt(2), the sum of whose squares is the square of the
/// strain tensor.
class StrainsOfState {
public:
    StrainsOfState(double k, Complex mu, Complex ratio, double scale)
        : k_(k), p_wave_(mu / ratio), lambda_(p_wave_ - 2.0 * mu), scale_(scale),
          shear_(scale / (mu * std::numbers::sqrt2)) {}
    Strains operator()(const State& s) const {
        return {k_ * s[0], (scale_ * s[2] + lambda_ * k_ * s[0]) / p_wave_, shear_ * s[3]};
    }

private:
    double k_;
    Complex p_wave_, lambda_;
    double scale_;
    Complex shear_;
};

/// (1 - e^-x) / x for Re x >= 0.
Complex mean_decay(Complex x) {
    if (x == 0.0) return 1.0;
    return std::norm(x) < 0.25 ? -exp_minus_one(-x) / x : (1.0 - std::exp(-x)) / x;
}

/// The integral of e^{-a z - b (h - z)} from 0 to h.
Complex opposite_decays(Complex a, Complex b, double h) {
    if (a.real() < b.real()) std::swap(a, b);
    return std::exp(-b * h) * h * mean_decay((a - b) * h);
}

/// The integral of the squares of the strains over a layer of thickness h, or a half-space, from
/// the products of its exponentials.
double by_exponentials(const LayerModes<double>& modes, const StrainsOfState& strains,
                       const InLayer& at, double h) {
    struct Term {
        Strains strains;
        Complex rate;
    };
    const std::array<Complex, 2> rates = {modes.alpha(), modes.beta()};
    const std::array<Pair, 2> factors = {modes.alpha_factors(), modes.beta_factors()};
    std::array<Term, 2> down, up;
    for (std::size_t i = 0; i < 2; ++i) {
        down[i] = {strains(factors[i] * at.down), rates[i]};
        up[i] = {strains(LayerModes<double>::mirrored(factors[i]) * at.up), rates[i]};
    }
    double sum = 0.0;
    for (const Term& a : down)
        for (const Term& b : down) {
            const Complex both = a.rate + std::conj(b.rate);
            const Complex length = at.radiates ? 1.0 / both : h * mean_decay(both * h);
            sum += (b.strains.dot(a.strains) * length).real();
        }
    if (at.radiates) return sum;
    for (const Term& a : up)
        for (const Term& b : up)
            sum += (b.strains.dot(a.strains) * h * mean_decay((a.rate + std::conj(b.rate)) * h))
                       .real();
    for (const Term& a : down)
        for (const Term& b : up)
            sum +=
                2.0 *
                (b.strains.dot(a.strains) * opposite_decays(a.rate, std::conj(b.rate), h)).real();
    return sum;
}

/// The same by Gauss-Legendre quadrature, for k so large that all exponentials decay like e^{-k z}.
double by_quadrature(const LayerModes<double>& modes, const StrainsOfState& strains,
                     const InLayer& at, double k, double h) {
    const GaussRule& gauss = gauss_rule();
    double sum = 0.0;
    const auto add = [&](double from, double to) {
        const int panels = std::max(1, static_cast<int>(std::ceil((to - from) * k / 6.0)));
        const double half = 0.5 * (to - from) / panels;
        for (int panel = 0; panel < panels; ++panel)
            for (std::size_t i = 0; i < GaussRule::order; ++i) {
                const double z = from + half * (2 * panel + 1 + gauss.node[i]);
                State state = modes.down(z) * at.down;
                if (!at.radiates) state += modes.up(h - z) * at.up;
                sum += half * gauss.weight[i] * strains(state).squaredNorm();
            }
    };
    const double reach = 18.0 / k; // e^{-2 k z} is 2e-16 there
    if (at.radiates) {
        add(0.0, reach);
    } else if (h < 2.0 * reach) {
        add(0.0, h);
    } else {
        add(0.0, reach);
        add(h - reach, h);
    }
    return sum;
}

} // namespace

StackResponse::StackResponse(const Medium& medium, Complex omega_rad_s,
                             std::span<const double> depths_m, StackQuantity quantity)
    : omega_rad_s_(omega_rad_s.real()), base_(medium.base), quantity_(quantity) {
    double top_m = 0.0;
    std::size_t next = 0;
    for (std::size_t i = 0; i < medium.layers.size(); ++i) {
        const Layer& layer = medium.layers[i];
        const bool last = i + 1 == medium.layers.size();
        LayerAtOmega at;
        at.thickness_m = last && base_ == Base::half_space ? 0.0 : layer.thickness_m;
        at.mu = shear_modulus(layer, omega_rad_s);
        const Complex m = p_wave_modulus(layer, omega_rad_s);
        const Complex inertia = layer.density_kg_m3 * omega_rad_s * omega_rad_s;
        at.kp2 = inertia / m;
        at.ks2 = inertia / at.mu;
        at.ratio = at.mu / m;
        at.first_depth = next;
        const double bottom_m = top_m + at.thickness_m;
        while (next < depths_m.size() &&
               (depths_m[next] <= bottom_m || (last && base_ == Base::half_space)))
            at.depths_m.push_back(depths_m[next++] - top_m);
        top_m = bottom_m;
        layers_.push_back(std::move(at));
    }
    if (next != depths_m.size()) throw Error("a requested depth lies below the medium");
    stress_scale_Pa_ = std::abs(layers_.front().mu);
}

void StackResponse::evaluate(double k, std::span<Complex> out) const {
    if (quantity_ == StackQuantity::loss)
        out[0] = loss(k);
    else
        evaluate_at(k, out);
}

void StackResponse::evaluate(Complex k, std::span<Complex> out) const {
    evaluate_at(k, out);
}

template <class Wavenumber, class Visit>
void StackResponse::solve(Wavenumber k, const Visit& visit) const {
    // Stresses are scaled by mu times this wavenumber, so that all rows have the same magnitude.
    const double wavenumber = std::max(std::abs(k), std::sqrt(std::abs(layers_.front().ks2)));
    const double scale = stress_scale_Pa_ * wavenumber;
    const auto modes_of = [&](const LayerAtOmega& layer) {
        return LayerModes<Wavenumber>(k, layer.mu, layer.kp2, layer.ks2, layer.ratio, scale);
    };

    // Upward pass: the admissible states at the top of the layers below (two columns), and the
    // continuation through each layer.
    const auto n = layers_.size();
    const std::size_t bounded = base_ == Base::half_space ? n - 1 : n;
    Pair states = Pair::Zero();
    if (base_ == Base::half_space) {
        states = modes_of(layers_.back()).down(0.0);
    } else {
        states(2, 0) = 1.0;
        states(3, 1) = 1.0;
    }
    thread_local std::vector<Continuation> continuations;
    continuations.resize(n);
    for (std::size_t i = bounded; i-- > 0;) {
        const LayerAtOmega& layer = layers_[i];
        const LayerModes<Wavenumber> modes = modes_of(layer);
        const Pair near = modes.down(0.0), far = modes.down(layer.thickness_m);
        continuations[i] = solve_bottom(LayerModes<Wavenumber>::mirrored(near), far, states);
        states = near + LayerModes<Wavenumber>::mirrored(far) * continuations[i].up;
    }

    // The load: sigma_zz = -1 Pa and sigma_rz = 0 at the surface.
    Eigen::Matrix<Complex, 2, 2> stress = states.bottomRows<2>();
    const Complex determinant = stress(0, 0) * stress(1, 1) - stress(0, 1) * stress(1, 0);
    Amplitudes amplitude;
    amplitude << -stress(1, 1) / (scale * determinant), stress(1, 0) / (scale * determinant);

    // Downward pass.
    const State top = states * amplitude;
    for (std::size_t i = 0; i < n; ++i) {
        InLayer at{.layer = i, .scale = scale, .surface = top, .down = amplitude};
        at.radiates = i >= bounded;
        if (!at.radiates) at.up = continuations[i].up * amplitude;
        if (!visit(at) || at.radiates) break;
        amplitude = continuations[i].below * amplitude;
    }
}

template <class Wavenumber>
void StackResponse::evaluate_at(Wavenumber given, std::span<Complex> out) const {
    const bool is_stress = quantity_ == StackQuantity::compression,
               is_tangential = quantity_ == StackQuantity::tangential;
    // U / k is regular at k = 0, but its quotient is not.
    const Wavenumber k = is_tangential && given == 0.0 ? Wavenumber(least_k_rad_m) : given;
    const int row = is_stress ? 2 : is_tangential ? 0 : 1;
    solve(k, [&](const InLayer& at) {
        const LayerAtOmega& layer = layers_[at.layer];
        const Wavenumber unit = is_stress       ? Wavenumber(-at.scale)
                                : is_tangential ? 1.0 / k
                                                : Wavenumber(1.0);
        for (std::size_t d = 0; d < layer.depths_m.size(); ++d) {
            const double z = layer.depths_m[d];
            Complex w = at.surface[row];
            if (at.layer > 0 || z > 0.0) {
                const LayerModes<Wavenumber> modes(k, layer.mu, layer.kp2, layer.ks2, layer.ratio,
                                                   at.scale);
                w = modes.down(z).row(row) * at.down;
                if (!at.radiates) w += Complex(modes.up(layer.thickness_m - z).row(row) * at.up);
            }
            out[layer.first_depth + d] = unit * w;
        }
        return layer.first_depth + layer.depths_m.size() < out.size();
    });
}

Complex StackResponse::loss(double k) const {
    if (omega_rad_s_ == 0.0) return 0.0;
    double in_layers = 0.0, below = 0.0;
    solve(k, [&](const InLayer& at) {
        const LayerAtOmega& layer = layers_[at.layer];
        const LayerModes<double> modes(k, layer.mu, layer.kp2, layer.ks2, layer.ratio, at.scale);
        const StrainsOfState strains(k, layer.mu, layer.ratio, at.scale);
        // Up to here the exponentials are integrated one by one with an error of 1e-10.
        const bool cancels = k > 20.0 * std::sqrt(std::abs(layer.ks2));
        const double squares = cancels ? by_quadrature(modes, strains, at, k, layer.thickness_m)
                                       : by_exponentials(modes, strains, at, layer.thickness_m);
        (at.radiates ? below : in_layers) += 2.0 * omega_rad_s_ * layer.mu.imag() * squares;
        return true;
    });
    return {in_layers, below};
}

double loss_factor(const Layer& layer, double frequency_Hz) {
    const Complex mu = shear_modulus(layer, two_pi * frequency_Hz);
    return mu.imag() / std::abs(mu);
}

const Layer& least_lossy_layer(const Medium& medium, double frequency_Hz) {
    return *std::ranges::min_element(
        medium.layers, {}, [&](const Layer& layer) { return loss_factor(layer, frequency_Hz); });
}

} // namespace shearwake::layered
