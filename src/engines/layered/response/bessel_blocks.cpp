// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/bessel_blocks.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;

/// cos z with one exponential; std::cos(z) calls cosh and sinh. |z| is moderate here.
Complex cosine(Complex z) {
    const double growing = 0.5 * std::exp(z.imag()), falling = 0.25 / growing;
    return {(falling + growing) * std::cos(z.real()), (falling - growing) * std::sin(z.real())};
}

/// The mean of cos(z cos(theta)) over the angles of a trapezoidal rule of 64 points, which is exact
/// to J_64(z).
Complex near_j0(Complex z) {
    constexpr std::size_t quarter = 16;
    static const std::array<double, quarter> nodes = [] {
        std::array<double, quarter> found;
        for (std::size_t j = 0; j < quarter; ++j)
            found[j] = std::cos(0.5 * std::numbers::pi * (static_cast<double>(j) + 0.5) / quarter);
        return found;
    }();
    Complex sum = 0.0;
    for (const double node : nodes)
        sum += cosine(z * node);
    return sum / static_cast<double>(quarter);
}

/// Hankel's asymptotic expansion; its smallest term at |z| = 25 is e^-50.
Complex far_j0(Complex z) {
    Complex p = 0.0, q = 0.0, term = 1.0;
    for (int k = 0; k < 40; ++k) {
        const double sign = (k / 2) % 2 == 0 ? 1.0 : -1.0;
        (k % 2 == 0 ? p : q) += sign * term;
        const double odd = 2.0 * k + 1.0;
        const Complex next = -term * (odd * odd) / (8.0 * (k + 1.0) * z);
        if (std::abs(next) < 1e-17 || std::abs(next) > std::abs(term)) break;
        term = next;
    }
    const Complex angle = z - 0.25 * std::numbers::pi;
    return std::sqrt(2.0 / (std::numbers::pi * z)) * (p * std::cos(angle) - q * std::sin(angle));
}

double bessel_j0(double x) {
    return ::j0(x);
}

} // namespace

Complex bessel_j0(Complex z) {
    return std::abs(z) < 25.0 ? near_j0(z) : far_j0(z);
}

template <class Scalar>
auto BesselBlocks<Scalar>::block(std::size_t first) const -> Matrix {
    const std::size_t count = std::min(radii_together, radii_ - first);
    Matrix values(static_cast<Eigen::Index>(count), std::ssize(k_rad_m_));
    for (Eigen::Index i = 0; i < values.cols(); ++i)
        for (Eigen::Index r = 0; r < values.rows(); ++r)
            values(r, i) =
                bessel_j0(k_rad_m_[static_cast<std::size_t>(i)] *
                          (static_cast<double>(first) + static_cast<double>(r)) * step_m_);
    return values;
}

template <class Scalar>
void BesselBlocks<Scalar>::multiply(
    const Matrix& weights,
    const std::function<bool(std::size_t first, const Matrix& products)>& use) {
    const bool is_cached = cached_B(k_rad_m_.size(), radii_) > 0.0;
    for (std::size_t first = 0, number = 0; first < radii_; first += radii_together, ++number) {
        if (is_cached && number == cached_.size()) cached_.push_back(block(first));
        const Matrix products =
            is_cached ? Matrix(cached_[number] * weights) : Matrix(block(first) * weights);
        if (!use(first, products)) return;
    }
}

template class BesselBlocks<double>;
template class BesselBlocks<Complex>;

} // namespace shearwake::layered
