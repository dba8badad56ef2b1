// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace shearwake::layered {

/// Piecewise Chebyshev approximation of a complex vector-valued function of k on [0, k_max]. Panels
/// of degree 15 are bisected until the last two coefficients of each component are below
/// `tolerance` times the largest one of the panel (or times 1e-6 of the first component, the
/// surface, if that is larger), or until they contribute less than `absolute` to the integral of
/// the function times k over the panel. Poles and branch points near the real axis increase the
/// number of panels. Where rounding prevents this accuracy, which happens next to poles with an
/// imaginary part below about 1e-7 k and for thin films, panels are bisected until their last
/// coefficients are rounding errors; these must then be below 1e-6 of the integral of |function| k
/// dk over all panels. No member function is collective.
class RadialInterpolant {
public:
    static constexpr int order = 16; // coefficients per panel

    using Function = std::function<void(double k, std::span<std::complex<double>> out)>;

    RadialInterpolant() = default;
    /// Approximates a function with values of length `components`. Throws CaseFailure if the error
    /// is larger (the function has a pole on the axis) or if a value is not finite.
    static RadialInterpolant fit(const Function& function, std::size_t components, double k_max,
                                 double tolerance, double absolute = 0.0);

    /// Values of one component at ascending k; result i is stored in out[i * stride].
    void evaluate(std::size_t component, std::span<const double> ascending_k,
                  std::complex<double>* out, std::ptrdiff_t stride) const;

    const std::vector<double>& edges() const { return edges_; }
    std::size_t panels() const { return edges_.empty() ? 0 : edges_.size() - 1; }

    /// Converts to and from a flat sequence that can be sent to other ranks.
    std::vector<std::complex<double>> packed() const;
    static RadialInterpolant unpacked(std::span<const std::complex<double>> packed,
                                      std::size_t components);

private:
    std::size_t components_ = 1;
    std::vector<double> edges_;                      // panels + 1, ascending
    std::vector<std::complex<double>> coefficients_; // (panel, component, order)
};

} // namespace shearwake::layered
