// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "studies/optimise/search/quotient.hpp"

#include <array>
#include <filesystem>
#include <vector>

namespace shearwake::optimise {

/// A sample of the surface and its weight in a bilinear interpolation.
struct WeightedSample {
    std::ptrdiff_t i = 0, j = 0;
    double weight = 0.0;
};
/// The four samples around each point of the drawn path, at most a grid spacing apart, that are
/// interpolated to it. None if the focus rests.
std::vector<std::array<WeightedSample, 4>> samples_along_path(const Case& c);

/// The uniformity of a computed case: the smallest rms of u over time along the path divided by the
/// mean along the path, from the time mean of u^2 in its file. NaN if the focus rests. Throws
/// FileFailure. Not collective.
double uniformity_of(const Case& c, const std::filesystem::path& file);

/// The quadratic forms of a quotient from the case files of all knots (knot_case()), which store
/// every frame: sums with the weights of the measures. Exact, since the field is linear in the
/// envelope. `c`: the case without envelope; `with_path`: also those of the points of the path.
/// Throws FileFailure. Not collective.
Forms gram_forms(const Case& c, const Quotient& quotient, bool with_path,
                 const std::vector<std::filesystem::path>& knot_files);

} // namespace shearwake::optimise
