// SPDX-License-Identifier: BSD-3-Clause
#include "sampling/design.hpp"

#include <algorithm>

namespace shearwake::sampling {

const std::vector<std::string>& sampling_names() {
    static const std::vector<std::string> names = {"sobol", "latin-hypercube", "random"};
    return names;
}

const std::vector<std::string>& analysis_names() {
    static const std::vector<std::string> names = {"distribution", "sobol-indices", "morris"};
    return names;
}

Design design_of(const UncertainPlan& plan) {
    const auto place = [](const std::vector<std::string>& names, const std::string& name) {
        return std::ranges::find(names, name) - names.begin();
    };
    return {.sampling = static_cast<Sampling>(place(sampling_names(), plan.sampling)),
            .analysis = static_cast<Analysis>(place(analysis_names(), plan.analysis)),
            .samples = plan.samples,
            .keys = plan.keys.size(),
            .seed = plan.seed};
}

std::size_t rows_per_sample(const Design& design) {
    switch (design.analysis) {
    case Analysis::sobol_indices:
        return design.keys + 2;
    case Analysis::morris:
        return design.keys + 1;
    case Analysis::distribution:
        break;
    }
    return 1;
}

Points design_points(const Design& design) {
    if (design.analysis == Analysis::distribution)
        return unit_points(design.sampling, design.samples, design.keys, design.seed);
    const auto keys = static_cast<std::ptrdiff_t>(design.keys);
    Points rows;
    for (const auto& pair :
         unit_points(design.sampling, design.samples, 2 * design.keys, design.seed)) {
        const std::vector<double> a(pair.begin(), pair.begin() + keys);
        const std::vector<double> b(pair.begin() + keys, pair.end());
        rows.push_back(a);
        if (design.analysis == Analysis::sobol_indices) rows.push_back(b);
        for (std::size_t i = 0; i < design.keys; ++i) {
            rows.push_back(a);
            rows.back()[i] = b[i];
        }
    }
    return rows;
}

} // namespace shearwake::sampling
