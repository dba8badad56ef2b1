// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <Eigen/Core>
#include <complex>
#include <cstddef>
#include <functional>
#include <vector>

namespace shearwake::layered {

/// J0 of a complex argument with |Im z| <= 10, to about 1e-15 e^{|Im z|}.
std::complex<double> bessel_j0(std::complex<double> z);

/// Number of radii that are computed together, which limits the memory.
inline constexpr std::size_t radii_together = 256;

/// The matrix of J0(k r) for wavenumbers k and radii r = 0, step, 2 step, ..., in blocks of
/// radii_together radii. It does not depend on the medium and takes as long as a product with it,
/// so it is cached from its first use on if it needs at most most_cached_B. Scalar: double or
/// std::complex<double>. Not collective.
template <class Scalar>
class BesselBlocks {
public:
    using Matrix = Eigen::Matrix<Scalar, Eigen::Dynamic, Eigen::Dynamic>;
    static constexpr double most_cached_B = 100e6;

    BesselBlocks(std::vector<Scalar> k_rad_m, double step_m, std::size_t radii)
        : k_rad_m_(std::move(k_rad_m)), step_m_(step_m), radii_(radii) {}

    std::size_t radii() const { return radii_; }
    const std::vector<Scalar>& k_rad_m() const { return k_rad_m_; }

    /// Passes J0 times `weights` ([k][column]) to `use`, block by block: the number of the first
    /// radius, and the products ([radius][column]). Ends early if `use` returns false.
    void multiply(const Matrix& weights,
                  const std::function<bool(std::size_t first, const Matrix& products)>& use);

    /// Memory in bytes of the cache.
    static double cached_B(std::size_t wavenumbers, std::size_t radii) {
        const double all_B =
            static_cast<double>(sizeof(Scalar) * wavenumbers) * static_cast<double>(radii);
        return all_B <= most_cached_B ? all_B : 0.0;
    }

private:
    Matrix block(std::size_t first) const;

    std::vector<Scalar> k_rad_m_;
    double step_m_;
    std::size_t radii_;
    std::vector<Matrix> cached_; // the first blocks
};

extern template class BesselBlocks<double>;
extern template class BesselBlocks<std::complex<double>>;

} // namespace shearwake::layered
