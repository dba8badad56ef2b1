// SPDX-License-Identifier: BSD-3-Clause
#include "engines/layered/response/radial_interpolant.hpp"

#include "base/error.hpp"
#include "engines/layered/kernels/response.hpp"
#include "fft/aligned.hpp"
#include "simd/kernels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>

namespace shearwake::layered {
namespace {

using Complex = std::complex<double>;
constexpr int chebyshev_terms = RadialInterpolant::order;
/// A component that is smaller than this share of the first one consists of rounding errors alone.
constexpr double negligible = 1e-6;

struct ChebyshevRule {
    std::array<double, chebyshev_terms> nodes; // on (-1, 1)
    std::array<std::array<double, chebyshev_terms>, chebyshev_terms> to_coefficients;
};

/// Chebyshev nodes of the first kind and the discrete cosine transform from values to coefficients.
ChebyshevRule make_rule() {
    ChebyshevRule rule;
    for (int i = 0; i < chebyshev_terms; ++i) {
        const double theta = std::numbers::pi * (i + 0.5) / chebyshev_terms;
        rule.nodes[static_cast<std::size_t>(i)] = std::cos(theta);
        for (int j = 0; j < chebyshev_terms; ++j)
            rule.to_coefficients[static_cast<std::size_t>(j)][static_cast<std::size_t>(i)] =
                (j == 0 ? 1.0 : 2.0) / chebyshev_terms * std::cos(j * theta);
    }
    return rule;
}

const ChebyshevRule rule = make_rule();

class Fitter {
public:
    Fitter(const RadialInterpolant::Function& function, std::size_t components, double tolerance,
           double absolute, double narrowest)
        : function_(function), components_(components), tolerance_(tolerance), absolute_(absolute),
          narrowest_(narrowest), values_(components * chebyshev_terms),
          panel_(components * chebyshev_terms) {}

    void refine(double from, double to, std::vector<double>& edges,
                std::vector<Complex>& coefficients) {
        const double centre = 0.5 * (from + to), half = 0.5 * (to - from);
        for (int i = 0; i < chebyshev_terms; ++i)
            function_(
                centre + half * rule.nodes[static_cast<std::size_t>(i)],
                std::span(values_).subspan(static_cast<std::size_t>(i) * components_, components_));
        if (resolved(absolute_ / (to * (to - from)))) {
            coefficients.insert(coefficients.end(), panel_.begin(), panel_.end());
            edges.push_back(to);
            return;
        }
        if (half < narrowest_)
            throw CaseFailure("the transfer function H(k, omega) cannot be resolved in k");
        refine(from, centre, edges, coefficients);
        refine(centre, to, edges, coefficients);
    }

private:
    /// Computes the coefficients of all components in panel_. Returns whether the last ones are
    /// small enough, or smaller than `negligible_tail`.
    bool resolved(double negligible_tail) {
        bool fine = true;
        double first = 0.0;
        for (std::size_t c = 0; c < components_; ++c) {
            double largest = 0.0;
            for (std::size_t j = 0; j < chebyshev_terms; ++j) {
                Complex sum = 0.0;
                for (std::size_t i = 0; i < chebyshev_terms; ++i)
                    sum += rule.to_coefficients[j][i] * values_[i * components_ + c];
                panel_[c * chebyshev_terms + j] = sum;
                largest = std::max(largest, std::abs(sum));
            }
            if (!std::isfinite(largest))
                throw CaseFailure("the transfer function H(k, omega) is not finite");
            const double tail =
                std::max(std::abs(panel_[c * chebyshev_terms + chebyshev_terms - 1]),
                         std::abs(panel_[c * chebyshev_terms + chebyshev_terms - 2]));
            if (c == 0) first = largest;
            const double allowed = tolerance_ * std::max(largest, negligible * first);
            fine = fine && tail <= std::max(allowed, negligible_tail);
        }
        return fine;
    }

    const RadialInterpolant::Function& function_;
    std::size_t components_;
    double tolerance_, absolute_, narrowest_;
    std::vector<Complex> values_, panel_;
};

} // namespace

RadialInterpolant RadialInterpolant::fit(const Function& function, std::size_t components,
                                         double k_max, double tolerance, double absolute) {
    RadialInterpolant result;
    result.components_ = components;
    result.edges_.push_back(0.0);
    Fitter(function, components, tolerance, absolute, 1e-12 * k_max)
        .refine(0.0, k_max, result.edges_, result.coefficients_);
    return result;
}

void RadialInterpolant::evaluate(std::size_t component, std::span<const double> ascending_k,
                                 Complex* out, std::ptrdiff_t stride) const {
    const ResponseKernels& kernels = simd::kernels<ResponseKernels>();
    std::vector<double> x; // arguments within one panel, mapped to (-1, 1)
    std::size_t panel = 0;
    for (auto k = ascending_k.begin(); k != ascending_k.end();) {
        while (panel + 2 < edges_.size() && *k > edges_[panel + 1])
            ++panel;
        const double from = edges_[panel], to = edges_[panel + 1];
        const bool is_last = panel + 2 == edges_.size();
        x.clear();
        for (; k != ascending_k.end() && (is_last || *k <= to); ++k)
            x.push_back(std::clamp((2.0 * *k - from - to) / (to - from), -1.0, 1.0));
        const Complex* c =
            coefficients_.data() + (panel * components_ + component) * chebyshev_terms;
        kernels.chebyshev(fft::reals(c), chebyshev_terms, x.data(), std::ssize(x), fft::reals(out),
                          stride);
        out += std::ssize(x) * stride;
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
    const std::size_t panels = (packed.size() - 1) / (1 + components * chebyshev_terms);
    RadialInterpolant result;
    result.components_ = components;
    for (std::size_t i = 0; i <= panels; ++i)
        result.edges_.push_back(packed[i].real());
    result.coefficients_.assign(packed.begin() + static_cast<std::ptrdiff_t>(panels + 1),
                                packed.end());
    return result;
}

} // namespace shearwake::layered
