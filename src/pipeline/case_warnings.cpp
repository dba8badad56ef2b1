// SPDX-License-Identifier: BSD-3-Clause
#include "pipeline/case_warnings.hpp"

#include "engines/registry/check.hpp"
#include "engines/registry/make_engine.hpp"
#include "problem/case/image_uplift.hpp"

#include <algorithm>
#include <cmath>
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

/// The share of the energy on the surface above which the uplift by images is reported. It is the
/// relative error of eta; that of the field (relative L2) is its square root, 10 %.
constexpr double tolerated_uplift = 0.01;

/// The estimate is that of a force; a prescribed motion has an unknown one.
bool has_a_force(const Case& c) {
    const auto* options = std::get_if<PstdOptions>(&c.solver);
    return !options || options->load == PstdLoad::traction;
}

void judge_image_uplift(const Case& c, const std::vector<double>& mean_u2,
                        std::vector<Remark>& warnings) {
    const bool invalid = std::ranges::any_of(warnings, [](const Remark& remark) {
        return remark.key == extent_key && remark.severity == Severity::error;
    });
    if (invalid || !has_a_force(c)) return;
    const double mean =
        std::accumulate(mean_u2.begin(), mean_u2.end(), 0.0) / static_cast<double>(mean_u2.size());
    const std::vector<double> uplift_m = image_uplift_m(c);
    const double square =
        std::inner_product(uplift_m.begin(), uplift_m.end(), uplift_m.begin(), 0.0) /
        static_cast<double>(uplift_m.size());
    if (!(square > tolerated_uplift * mean)) return;
    warnings.push_back(
        {Severity::warning, extent_key,
         fmt::format("the skin rises around a load at once and at all distances; the images of the "
                     "load beyond the periodic edges lift the whole domain by about {:.2g} um at "
                     "the end of the run, which changes the field by about {:.2g} % (relative L2) "
                     "and eta by about {:.2g} %; {}",
                     1e6 * uplift_m.back(), 100.0 * std::sqrt(square / mean), 100.0 * square / mean,
                     std::holds_alternative<LayeredOptions>(c.solver)
                         ? "domain.edges = \"open\" avoids it, and a larger domain reduces it"
                         : "a larger domain reduces it")});
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
    if (!mean_u2.empty() && !c.study() && edges == engines::Edges::periodic) {
        judge_returning_waves(edge_share(c.domain, mean_u2), warnings);
        judge_image_uplift(c, mean_u2, warnings);
    }
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
