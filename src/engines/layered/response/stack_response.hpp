// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/medium/medium.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Computed quantity: W / p [m/Pa]; -sigma_zz / p [1], positive in compression; U / (k p) [m^2/Pa],
/// the potential of the tangential displacement; or the loss (see StackResponse::loss).
enum class StackQuantity { displacement, compression, tangential, loss };

/// Exact response of a stack of layers to a normal surface load at one complex frequency, H(k,
/// omega; z) = W(z) / p, see docs/explanation/engine-layered.md: u_r = i U(z), u_z = W(z), with the
/// traction p e^{i(omega t - k.x)} pushing into the tissue. Every exponential is scaled to 1 at an
/// interface, so that nothing overflows at large k h. The two downgoing solutions are combined so
/// that they stay independent and free of cancellation as alpha -> beta (k >> omega / c_s). Not
/// collective.
class StackResponse {
public:
    /// `medium` has at least one layer; omega [rad/s] with Im omega <= 0; depths [m] in ascending
    /// order within the stack. Throws Error if a depth lies outside.
    StackResponse(const Medium& medium, std::complex<double> omega_rad_s,
                  std::span<const double> depths_m,
                  StackQuantity quantity = StackQuantity::displacement);

    /// Stores the quantity at each depth in `out`. k >= 0 [rad/m]; k and omega
    /// must not both be 0. The loss does not depend on the depths.
    void evaluate(double k_rad_m, std::span<std::complex<double>> out) const;
    /// The analytic continuation to the first quadrant of k, where H has no poles.
    void evaluate(std::complex<double> k_rad_m, std::span<std::complex<double>> out) const;

    /// Mean power that viscosity absorbs per |p|^2 and area [m/(Pa s)], for real frequencies: the
    /// integral over depth of 2 omega Im(mu) (k^2 |U|^2 + |W'|^2 + |U' + k W|^2 / 2). The real part
    /// belongs to the layers of finite thickness, the imaginary part to the half-space below them,
    /// where it equals the power that is radiated into it. Without a lossless layer their sum
    /// equals the power of the load, -omega Im H.
    std::complex<double> loss(double k_rad_m) const;

private:
    template <class Wavenumber>
    void evaluate_at(Wavenumber k_rad_m, std::span<std::complex<double>> out) const;
    /// Calls visit(InLayer) for the layers from the top until it returns false.
    template <class Wavenumber, class Visit>
    void solve(Wavenumber k_rad_m, const Visit& visit) const;

    struct LayerAtOmega {
        double thickness_m = 0.0; // 0: half-space
        std::complex<double> mu;  // [Pa]
        std::complex<double> kp2; // (omega / c_p)^2 [1/m^2]
        std::complex<double> ks2;
        std::complex<double> ratio;   // mu / (lambda + 2 mu) = kp2 / ks2
        std::vector<double> depths_m; // from this layer's top
        std::size_t first_depth = 0;
    };
    std::vector<LayerAtOmega> layers_;
    double omega_rad_s_ = 0.0; // real part
    Base base_ = Base::rigid;
    double stress_scale_Pa_ = 1.0;
    StackQuantity quantity_;
};

/// Im mu / |mu| at this frequency. Not collective.
double loss_factor(const Layer& layer, double frequency_Hz);
/// The layer with the smallest loss factor at this frequency, of at least one layer. Not
/// collective.
const Layer& least_lossy_layer(const Medium& medium, double frequency_Hz);

} // namespace shearwake::layered
