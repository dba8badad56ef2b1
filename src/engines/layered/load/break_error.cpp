// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/load/break_error.hpp"

#include "base/units.hpp"
#include "engines/layered/response/gauss_rule.hpp"
#include "engines/layered/response/stack_response.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <tuple>
#include <vector>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

/// Any even length: only the frequencies of the fit relative to the highest one matter.
constexpr std::ptrdiff_t probe_samples = 1024;

} // namespace

BreakError::BreakError(const Case& c, std::span<const Break> breaks, double cell_s)
    : case_(c), cell_s_(cell_s) {
    for (const Break& each : breaks) {
        sizes_[0] = std::max(sizes_[0], each.jump);
        sizes_[1] = std::max(sizes_[1], each.kink);
        sizes_[2] = std::max(sizes_[2], each.bend);
    }
    if (breaks.empty()) return;
    choose_wavenumbers();
    // A frequency at which H has about the magnitude of the field.
    const double omega_rad_s =
        std::max(0.5 * std::numbers::pi / c.time.duration_s(),
                 0.5 * greatest_speed_m_s(c.scene().load.modulation.trajectory) / sigma_m_);
    typical_m_Pa_ = at_focus({omega_rad_s, -0.1 * omega_rad_s}).cwiseAbs();
}

/// Gauss-Laguerre quadrature in (k sigma)^2 / 2 for a Gaussian of the same band, as if the spectrum
/// of the footprint were that along x in all directions.
void BreakError::choose_wavenumbers() {
    const Footprint& footprint = case_.scene().load.footprint;
    sigma_m_ =
        std::sqrt(-2.0 * std::log(band_fraction)) / bandwidth_rad_m(footprint, band_fraction);
    Eigen::Matrix<double, wavenumbers, wavenumbers> jacobi;
    jacobi.setZero();
    for (int i = 0; i < wavenumbers; ++i) {
        jacobi(i, i) = 2 * i + 1;
        if (i > 0) jacobi(i, i - 1) = jacobi(i - 1, i) = i;
    }
    const Eigen::SelfAdjointEigenSolver<decltype(jacobi)> solver(jacobi);
    for (int i = 0; i < wavenumbers; ++i) {
        const auto at = static_cast<std::size_t>(i);
        const double u = solver.eigenvalues()(i);
        k_rad_m_[at] = std::sqrt(2.0 * u) / sigma_m_;
        const double gaussian_m2 = two_pi * sigma_m_ * sigma_m_ * std::exp(-u);
        weight_[at] = std::pow(solver.eigenvectors()(0, i), 2) *
                      spectrum(footprint, k_rad_m_[at], 0.0) / gaussian_m2;
    }
}

Eigen::VectorXcd BreakError::at_focus(Complex omega_rad_s) const {
    const std::vector<double>& depths_m = case_.measure.depths_m;
    const StackResponse response(case_.scene().medium, omega_rad_s, depths_m);
    Eigen::VectorXcd sum = Eigen::VectorXcd::Zero(std::ssize(depths_m)), h(std::ssize(depths_m));
    for (std::size_t i = 0; i < k_rad_m_.size(); ++i) {
        response.evaluate(k_rad_m_[i], {h.data(), depths_m.size()});
        sum += weight_[i] * h;
    }
    return sum;
}

double BreakError::relative(double step_s) const {
    if (typical_m_Pa_.size() == 0) return 0.0;
    // Damped by 0.2 per step, which smooths the resonances between the few wavenumbers.
    const auto response = [&](double x) { return at_focus(Complex(x, -0.2) / step_s); };
    const TailFit fit(probe_samples, StackQuantity::displacement);
    const Eigen::Index depths = typical_m_Pa_.size();
    Eigen::MatrixXd fitted(fit.matrix().cols(), depths);
    for (std::size_t v = 0; v < fit.frequencies().size(); ++v) {
        const Eigen::VectorXcd h =
            response(two_pi * static_cast<double>(fit.frequencies()[v]) / probe_samples);
        fitted.row(static_cast<Eigen::Index>(2 * v)) = h.real();
        fitted.row(static_cast<Eigen::Index>(2 * v + 1)) = h.imag();
    }
    const Eigen::MatrixXd powers = fit.matrix() * fitted; // [power][depth]

    // What the powers leave out, as signals at s steps after a jump, a kink and a bend.
    constexpr int instants = 33;
    std::array<Eigen::MatrixXd, orders> left; // [depth][instant]
    left.fill(Eigen::MatrixXd::Zero(depths, instants));
    for (const auto& [from, to, nodes] : {std::tuple(0.8, 1.6, 12), std::tuple(1.6, 4.8, 28)})
        for (const auto& [node, weight] : gauss_nodes(nodes)) {
            const double half = 0.5 * (to - from) * std::numbers::pi;
            const double x = half * (1.0 + node) + from * std::numbers::pi;
            Eigen::VectorXcd h = response(x);
            for (Eigen::Index a = 0; a < powers.rows(); ++a)
                h -= std::pow(Complex(0.0, x), -static_cast<int>(a) - fit.lowest_power()) *
                     powers.row(a).transpose();
            h *= weight * half * (1.0 - roll_off(x / std::numbers::pi)) / std::numbers::pi;
            for (Eigen::MatrixXd& signal : left) {
                h /= Complex(0.0, x);
                for (int n = 0; n < instants; ++n)
                    signal.col(n) += (h * std::polar(1.0, 0.25 * x * (n - instants / 2))).real();
            }
        }
    Eigen::MatrixXd error = Eigen::MatrixXd::Zero(depths, instants);
    for (std::size_t b = 0; b < orders; ++b)
        error += sizes_[b] * std::pow(step_s / cell_s_, b) * left[b].cwiseAbs();
    return error.rowwise().maxCoeff().cwiseQuotient(typical_m_Pa_).maxCoeff();
}

} // namespace shearwake::layered
