// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/plan.hpp"
#include "sampling/points.hpp"

#include <string>
#include <vector>

namespace shearwake::sampling {

/// What a sample is for, which determines its points.
enum class Analysis { distribution, sobol_indices, morris };

/// A design of `samples` blocks in `keys` dimensions. Row `sample * rows_per_sample + r` is row r
/// of the block; extending a design appends blocks.
struct Design {
    Sampling sampling = Sampling::sobol;
    Analysis analysis = Analysis::distribution;
    std::size_t samples = 0;
    std::size_t keys = 0;
    std::uint64_t seed = 0;
};

/// The words for the members of Sampling and Analysis in jobs, in their order.
const std::vector<std::string>& sampling_names();
const std::vector<std::string>& analysis_names();

/// The design of a plan.
Design design_of(const UncertainPlan& plan);

/// The number of rows per block:
/// * distribution: 1, the point.
/// * sobol_indices: keys + 2, the design of Saltelli et al. (2010): A, B, and A with coordinate i
/// of
///   B for each key i.
/// * morris: keys + 1, the radial design of Campolongo, Saltelli and Cariboni (2011): A, and A with
///   coordinate i of B for each key i.
std::size_t rows_per_sample(const Design& design);

/// The rows of the design in the unit cube. A and B are the two halves of a point in twice as many
/// dimensions.
Points design_points(const Design& design);

} // namespace shearwake::sampling
