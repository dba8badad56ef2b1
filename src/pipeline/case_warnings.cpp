// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_warnings.hpp"

#include "check/check.hpp"
#include "engines/registry/make_engine.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace shearwake::pipeline {
namespace {

constexpr const char* extent_key = "domain.extent_mm";
/// Energy on the edges, relative to the mean, above which the readings are not valid: it returns
/// through the opposite edge, so that it is also the order of the relative error of eta.
constexpr double invalid_share = 0.05;
/// Below this share, returning waves change no digit that a report prints.
constexpr double negligible_share = 1e-3;

/// Replaces the expectation of `check` by what was computed.
void judge_returning_waves(double share, std::vector<Remark>& warnings) {
    std::erase_if(warnings, [&](const Remark& remark) {
        return remark.key == extent_key && share < negligible_share;
    });
    for (Remark& remark : warnings) {
        if (remark.key != extent_key) continue;
        const bool invalid = share > invalid_share;
        remark.message += fmt::format(
            ". On the edges of the domain, u_z^2 is {:.2g} % of its mean: {}", 100.0 * share,
            invalid ? "the readings of this case are not valid"
                    : "expect errors of this order in eta");
        if (invalid) remark.severity = Severity::error;
    }
}

} // namespace

double edge_share(const Domain& domain, const std::vector<double>& mean_u2) {
    const auto at = [&](std::ptrdiff_t i, std::ptrdiff_t j) {
        return mean_u2[static_cast<std::size_t>(i * domain.ny + j)];
    };
    const double mean = std::accumulate(mean_u2.begin(), mean_u2.end(), 0.0) /
                        static_cast<double>(domain.nx * domain.ny);
    if (!(mean > 0.0)) return 0.0;
    // The rows i = 0 and i = nx - 1 are neighbours across the periodic edge.
    double edge = 0.0;
    for (std::ptrdiff_t i = 0; i < domain.nx; ++i)
        edge += at(i, 0);
    for (std::ptrdiff_t j = 1; j < domain.ny; ++j)
        edge += at(0, j);
    return edge / static_cast<double>(domain.nx + domain.ny - 1) / mean;
}

std::vector<Remark> case_warnings(const Case& c, const std::vector<Remark>& solver,
                                  const std::vector<std::string>& afferents,
                                  const std::vector<double>& mean_u2) {
    std::vector<Remark> warnings = check(c);
    const auto edges = engines::make_engine(c.solver)->edges(c);
    if (!mean_u2.empty() && !c.study() && edges == engines::Edges::periodic)
        judge_returning_waves(edge_share(c.domain, mean_u2), warnings);
    for (const Remark& warning : solver) // some follow from the case alone
        if (std::ranges::find(warnings, warning) == warnings.end()) warnings.push_back(warning);
    for (const std::string& line : afferents) {
        const std::size_t colon = line.find(": ");
        if (colon == std::string::npos) continue;
        warnings.push_back({Severity::warning, line.substr(0, colon), line.substr(colon + 2)});
    }
    return warnings;
}

} // namespace shearwake::pipeline
