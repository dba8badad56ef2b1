// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "studies/laboratory/converted_data.hpp"
#include "studies/laboratory/least_squares.hpp"

#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// A fit with a simpler material law. A negative change of the Bayesian information criterion means
/// that the simpler law suffices.
struct SimplerFit {
    std::string key, law;
    double change = 0.0;
};

struct FitOutput {
    const std::vector<Parameter>& parameters;
    const ConvertedData& data;
    std::span<const double> observed; // one row of samples per point
    std::size_t samples;
    const FitResult& result;
    const std::vector<SimplerFit>& simpler;
};

/// Writes fit.json and fit.h5. Not collective.
void write_fit(const std::filesystem::path& folder, const std::filesystem::path& job,
               const FitOutput& output);

/// Not collective.
void print_fit(const FitOutput& output);

} // namespace shearwake::laboratory
