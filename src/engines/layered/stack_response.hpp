#pragma once

#include "model/medium.hpp"

#include <complex>
#include <span>
#include <vector>

namespace shearwake {

/// What of a stack is asked for: W / p [m/Pa], or -sigma_zz / p [1], compression positive.
enum class StackQuantity { displacement, compression };

/// The exact answer of a stack of layers to a normal surface load at one complex frequency:
/// H(k, omega; z) = W(z) / p, PHYSICS: u_r = i U(z), u_z = W(z), traction p e^{i(omega t - k.x)}
/// pushing into the tissue. Every exponential is scaled from the interface where it is 1, so that
/// nothing overflows at any k h; the two downgoing solutions are combined so that they stay
/// independent where alpha -> beta (k >> omega / c_s), so that nothing cancels there.
class StackResponse {
public:
    /// Medium with at least one layer; omega [rad/s], Im omega <= 0; depths [m] ascending, inside
    /// the stack. Throws Error when a depth is outside.
    StackResponse(const Medium& medium, std::complex<double> omega_rad_s,
                  std::span<const double> depths_m,
                  StackQuantity quantity = StackQuantity::displacement);

    /// H [m/Pa], or the compression [1], at each depth, into `out`. k >= 0 [rad/m]; k = omega = 0
    /// has no answer.
    void evaluate(double k_rad_m, std::span<std::complex<double>> out) const;

private:
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
    Base base_ = Base::rigid;
    double stress_scale_Pa_ = 1.0;
    StackQuantity quantity_;
};

/// W/p of a homogeneous half-space in closed form, -alpha k_s^2 / (mu R), R the Rayleigh function
/// (2k^2 - k_s^2)^2 - 4 k^2 alpha beta, written without cancellation for k >> k_s [m/Pa].
std::complex<double> half_space_response(const Layer& layer, std::complex<double> omega_rad_s,
                                         double k_rad_m);

} // namespace shearwake
