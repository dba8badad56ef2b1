#pragma once

#include <complex>
#include <functional>
#include <span>
#include <vector>

namespace shearwake {

/// A complex vector-valued function of k on [0, k_max] as Chebyshev panels: degree 15 on each, cut
/// in half until the last two coefficients are below `tolerance` times the panel's largest one (or
/// times 1e-6 of the first component's, the surface's, where that is more).
/// Poles and branch points near the real axis cost panels, never accuracy.
class RadialInterpolant {
public:
    static constexpr int order = 16; // coefficients per panel

    using Function = std::function<void(double k, std::span<std::complex<double>> out)>;

    RadialInterpolant() = default;
    /// `components`: length of the function's value. Throws CaseFailure when a panel narrower than
    /// 1e-12 k_max would still not do (the function is not analytic on the axis) or is not finite.
    static RadialInterpolant fit(const Function& function, std::size_t components, double k_max,
                                 double tolerance);

    /// Values of one component at ascending k, out[i * stride].
    void evaluate(std::size_t component, std::span<const double> ascending_k,
                  std::complex<double>* out, std::ptrdiff_t stride) const;

    std::size_t panels() const { return edges_.empty() ? 0 : edges_.size() - 1; }

    /// As one flat sequence, to be sent to other ranks; and back.
    std::vector<std::complex<double>> packed() const;
    static RadialInterpolant unpacked(std::span<const std::complex<double>> packed,
                                      std::size_t components);
    static std::size_t packed_size(std::size_t panels, std::size_t components) {
        return panels + 1 + panels * components * order;
    }

private:
    std::size_t components_ = 1;
    std::vector<double> edges_;                      // panels + 1, ascending
    std::vector<std::complex<double>> coefficients_; // (panel, component, order)
};

} // namespace shearwake
