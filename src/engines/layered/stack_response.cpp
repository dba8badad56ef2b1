// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/stack_response.hpp"

#include "base/error.hpp"

#include <Eigen/Dense>
#include <cmath>

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
/// first one is the compressional wave with coefficient A of docs/developer/physics.md, section 3.
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
    Pair up(double zeta) const {
        Pair s = down(zeta);
        s.row(1) = -s.row(1);
        s.row(3) = -s.row(3);
        return s;
    }

private:
    /// (e^{-beta zeta} - e^{-alpha zeta}) / (alpha - beta).
    Complex spread(double zeta, Complex e_alpha, Complex e_beta) const {
        const Complex x = difference_ * zeta;
        if (std::abs(x) > 0.5) return (e_beta - e_alpha) / difference_;
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

Continuation solve_bottom(const Pair& up_at_bottom, const Pair& down_at_bottom, const Pair& below) {
    Eigen::Matrix<Complex, 4, 4> a;
    a << up_at_bottom, -below;
    Eigen::Array<double, 4, 1> norms;
    for (int column = 0; column < 4; ++column) {
        norms[column] = a.col(column).cwiseAbs().maxCoeff();
        a.col(column) /= norms[column];
    }
    Eigen::Matrix<Complex, 4, 2> x = a.partialPivLu().solve(-down_at_bottom);
    for (int row = 0; row < 4; ++row)
        x.row(row) /= norms[row];
    return {x.topRows<2>(), x.bottomRows<2>()};
}

} // namespace

StackResponse::StackResponse(const Medium& medium, Complex omega_rad_s,
                             std::span<const double> depths_m, StackQuantity quantity)
    : base_(medium.base), quantity_(quantity) {
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
    evaluate_at(k, out);
}

void StackResponse::evaluate(Complex k, std::span<Complex> out) const {
    evaluate_at(k, out);
}

template <class Wavenumber>
void StackResponse::evaluate_at(Wavenumber given, std::span<Complex> out) const {
    // U / k is regular at k = 0, but its quotient is not.
    const Wavenumber k =
        quantity_ == StackQuantity::tangential && given == 0.0 ? Wavenumber(least_k_rad_m) : given;
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
        continuations[i] = solve_bottom(modes.up(0.0), modes.down(layer.thickness_m), states);
        states = modes.down(0.0) + modes.up(layer.thickness_m) * continuations[i].up;
    }

    // The load: sigma_zz = -1 Pa and sigma_rz = 0 at the surface.
    Eigen::Matrix<Complex, 2, 2> stress = states.bottomRows<2>();
    const Complex determinant = stress(0, 0) * stress(1, 1) - stress(0, 1) * stress(1, 0);
    Eigen::Matrix<Complex, 2, 1> amplitude;
    amplitude << -stress(1, 1) / (scale * determinant), stress(1, 0) / (scale * determinant);

    // Downward pass: the amplitudes in each layer that contains a requested depth.
    const int row = quantity_ == StackQuantity::compression  ? 2
                    : quantity_ == StackQuantity::tangential ? 0
                                                             : 1;
    const Wavenumber unit = quantity_ == StackQuantity::compression  ? Wavenumber(-scale)
                            : quantity_ == StackQuantity::tangential ? 1.0 / k
                                                                     : Wavenumber(1.0);
    for (std::size_t i = 0; i < n; ++i) {
        const LayerAtOmega& layer = layers_[i];
        const bool radiating = i >= bounded;
        for (std::size_t d = 0; d < layer.depths_m.size(); ++d) {
            const double z = layer.depths_m[d];
            Complex w;
            if (i == 0 && z == 0.0) {
                w = states.row(row) * amplitude;
            } else {
                const LayerModes<Wavenumber> modes = modes_of(layer);
                w = modes.down(z).row(row) * amplitude;
                if (!radiating)
                    w += Complex(modes.up(layer.thickness_m - z).row(row) *
                                 (continuations[i].up * amplitude));
            }
            out[layer.first_depth + d] = unit * w;
        }
        if (layer.first_depth + layer.depths_m.size() >= out.size() || radiating) break;
        amplitude = continuations[i].below * amplitude;
    }
}

Complex half_space_response(const Layer& layer, Complex omega_rad_s, double k) {
    const Complex mu = shear_modulus(layer, omega_rad_s);
    const Complex m = p_wave_modulus(layer, omega_rad_s);
    const Complex inertia = layer.density_kg_m3 * omega_rad_s * omega_rad_s;
    const Complex kp2 = inertia / m, ks2 = inertia / mu, ratio = mu / m;
    const double k2 = k * k;
    const Complex alpha = std::sqrt(k2 - kp2), beta = std::sqrt(k2 - ks2);
    // R / k_s^2 = -4 k^2 + k_s^2 + 4 k^2 (k^2 - alpha beta) / k_s^2, and
    // (k^2 - alpha beta) / k_s^2 = (k^2 (1 + ratio) - k_p^2) / (k^2 + alpha beta).
    const Complex reduced =
        -4.0 * k2 + ks2 + 4.0 * k2 * (k2 * (1.0 + ratio) - kp2) / (k2 + alpha * beta);
    return -alpha / (mu * reduced);
}

} // namespace shearwake::layered
