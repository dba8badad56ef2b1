// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/quotient.hpp"

#include "base/units.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace shearwake::optimise {

namespace {

std::vector<std::pair<std::string, Quotient>> named_quotients(const Case& c) {
    std::vector<std::pair<std::string, Quotient>> found = {
        {"eta_period_1", {.kind = Quotient::Kind::efficiency, .band = {}}},
        {"sharpness_1", {.kind = Quotient::Kind::sharpness, .band = {}}}};
    for (const FrequencyBand& band : c.measure.bands) {
        const std::string name = fmt::format("share_{:g}_{:g}_1", band.low_Hz, band.high_Hz);
        found.emplace_back(name, Quotient{.kind = Quotient::Kind::share, .band = band});
        found.emplace_back("velocity_" + name,
                           Quotient{.kind = Quotient::Kind::velocity_share, .band = band});
    }
    return found;
}

} // namespace

std::vector<std::string> quotients_of(const Case& c) {
    std::vector<std::string> names;
    for (const auto& named : named_quotients(c))
        names.push_back(named.first);
    return names;
}

std::optional<Quotient> find_quotient(const Case& c, const std::string& column) {
    for (const auto& named : named_quotients(c))
        if (named.first == column) return named.second;
    return std::nullopt;
}

Vec2 trace_m(const Case& c) {
    const std::vector<Vec2>& traces = c.record.traces_m;
    const bool has_centre = std::ranges::find(traces, Vec2{}) != traces.end();
    return traces.empty() || has_centre ? Vec2{} : traces.front();
}

double eta(const Forms& forms, const Eigen::VectorXd& envelope) {
    return envelope.dot(forms.numerator * envelope) / envelope.dot(forms.denominator * envelope);
}

Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope) {
    const Eigen::VectorXd n = forms.numerator * envelope, d = forms.denominator * envelope;
    const double below = envelope.dot(d);
    return 2.0 / below * (n - envelope.dot(n) / below * d);
}

double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope) {
    return envelope.dot(forms.focal * envelope) / forms.reference_energy();
}

Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope) {
    return 2.0 / forms.reference_energy() * (forms.focal * envelope);
}

Eigen::VectorXd rms_along_path(const Forms& forms, const Eigen::VectorXd& envelope) {
    Eigen::VectorXd rms(std::ssize(forms.path));
    for (Eigen::Index k = 0; k < rms.size(); ++k)
        rms(k) = std::sqrt(std::max(
            0.0, envelope.dot(forms.path[static_cast<std::size_t>(k)] * envelope))); // rounding
    return rms;
}

double uniformity(const Eigen::VectorXd& rms) {
    return rms.size() > 0 ? rms.minCoeff() / rms.mean() : not_a_number;
}

} // namespace shearwake::optimise
