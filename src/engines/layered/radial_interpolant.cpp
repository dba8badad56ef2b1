#include "engines/layered/radial_interpolant.hpp"

#include "base/error.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace shearwake {
namespace {

using Complex = std::complex<double>;
constexpr int n = RadialInterpolant::order;
/// Below this share of the first component, a component's rounding errors are all there is to fit.
constexpr double floor = 1e-6;

struct ChebyshevRule {
    std::array<double, n> nodes; // on (-1, 1)
    std::array<std::array<double, n>, n> to_coefficients;
};

/// Nodes of the first kind and the discrete cosine transform that turns values into coefficients.
ChebyshevRule make_rule() {
    ChebyshevRule rule;
    for (int i = 0; i < n; ++i) {
        const double theta = std::numbers::pi * (i + 0.5) / n;
        rule.nodes[static_cast<std::size_t>(i)] = std::cos(theta);
        for (int j = 0; j < n; ++j)
            rule.to_coefficients[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
                (j == 0 ? 1.0 : 2.0) / n * std::cos(j * theta);
    }
    return rule;
}

const ChebyshevRule rule = make_rule();

class Fitter {
public:
    Fitter(const RadialInterpolant::Function& function, std::size_t components, double tolerance,
           double narrowest)
        : function_(function), components_(components), tolerance_(tolerance),
          narrowest_(narrowest), values_(components * n), panel_(components * n) {}

    void refine(double from, double to, std::vector<double>& edges,
                std::vector<Complex>& coefficients) {
        const double centre = 0.5 * (from + to), half = 0.5 * (to - from);
        for (int i = 0; i < n; ++i)
            function_(
                centre + half * rule.nodes[static_cast<std::size_t>(i)],
                std::span(values_).subspan(static_cast<std::size_t>(i) * components_, components_));
        if (resolved()) {
            coefficients.insert(coefficients.end(), panel_.begin(), panel_.end());
            edges.push_back(to);
            return;
        }
        if (half < narrowest_) throw CaseFailure("H(k, omega) cannot be resolved in k");
        refine(from, centre, edges, coefficients);
        refine(centre, to, edges, coefficients);
    }

private:
    /// Coefficients of all components into panel_; whether their tails are short enough.
    bool resolved() {
        bool fine = true;
        double first = 0.0;
        for (std::size_t c = 0; c < components_; ++c) {
            double largest = 0.0;
            for (std::size_t j = 0; j < n; ++j) {
                Complex sum = 0.0;
                for (std::size_t i = 0; i < n; ++i)
                    sum += rule.to_coefficients[j][i] * values_[i * components_ + c];
                panel_[c * n + j] = sum;
                largest = std::max(largest, std::abs(sum));
            }
            if (!std::isfinite(largest)) throw CaseFailure("H(k, omega) is not finite");
            const double tail =
                std::max(std::abs(panel_[c * n + n - 1]), std::abs(panel_[c * n + n - 2]));
            if (c == 0) first = largest;
            fine = fine && tail <= tolerance_ * std::max(largest, floor * first);
        }
        return fine;
    }

    const RadialInterpolant::Function& function_;
    std::size_t components_;
    double tolerance_, narrowest_;
    std::vector<Complex> values_, panel_;
};

} // namespace

RadialInterpolant RadialInterpolant::fit(const Function& function, std::size_t components,
                                         double k_max, double tolerance) {
    RadialInterpolant result;
    result.components_ = components;
    result.edges_.push_back(0.0);
    Fitter(function, components, tolerance, 1e-12 * k_max)
        .refine(0.0, k_max, result.edges_, result.coefficients_);
    return result;
}

void RadialInterpolant::evaluate(std::size_t component, std::span<const double> ascending_k,
                                 Complex* out, std::ptrdiff_t stride) const {
    std::size_t panel = 0;
    for (const double k : ascending_k) {
        while (panel + 2 < edges_.size() && k > edges_[panel + 1])
            ++panel;
        const double from = edges_[panel], to = edges_[panel + 1];
        const double x = std::clamp((2.0 * k - from - to) / (to - from), -1.0, 1.0);
        // sum c_j T_j(x), even and odd terms side by side: T_j by the recurrence in steps of two.
        const Complex* c = coefficients_.data() + (panel * components_ + component) * n;
        const double t2 = 2.0 * (2.0 * x * x - 1.0); // T_{j+2} = 2 T_2 T_j - T_{j-2}
        double even = 1.0, even_before = 0.5 * t2, odd = x, odd_before = x;
        double re = 0.0, im = 0.0;
        for (int j = 0; j < n; j += 2) {
            re += c[j].real() * even + c[j + 1].real() * odd;
            im += c[j].imag() * even + c[j + 1].imag() * odd;
            const double even_next = t2 * even - even_before, odd_next = t2 * odd - odd_before;
            even_before = even;
            odd_before = odd;
            even = even_next;
            odd = odd_next;
        }
        *out = {re, im};
        out += stride;
    }
}

std::vector<Complex> RadialInterpolant::packed() const {
    std::vector<Complex> all(edges_.begin(), edges_.end());
    all.insert(all.end(), coefficients_.begin(), coefficients_.end());
    return all;
}

RadialInterpolant RadialInterpolant::unpacked(std::span<const Complex> packed,
                                              std::size_t components) {
    // size = (panels + 1) + panels * components * order.
    const std::size_t panels = (packed.size() - 1) / (1 + components * n);
    RadialInterpolant result;
    result.components_ = components;
    for (std::size_t i = 0; i <= panels; ++i)
        result.edges_.push_back(packed[i].real());
    result.coefficients_.assign(packed.begin() + static_cast<std::ptrdiff_t>(panels + 1),
                                packed.end());
    return result;
}

} // namespace shearwake
