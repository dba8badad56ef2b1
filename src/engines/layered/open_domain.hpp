// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "fft/slab_transform.hpp"
#include "problem/case/case.hpp"

namespace shearwake::layered {

/// The grid on which a case is solved: its domain or, with open edges, the domain enlarged on all
/// sides so that a periodic convolution equals that on the infinite plane. The enlargement is a
/// whole number of eighths of the domain and at most its size, so that cases with similar paths
/// share their tables. Not collective.
Domain solved_domain(const Case& c);
/// The case on that grid. Not collective.
Case solved_case(const Case& c);

/// The part of the rows of a rank on the solved grid that lies inside the domain.
struct InnerRows {
    std::ptrdiff_t x_start = 0, x_count = 0; // rows of the domain
    std::ptrdiff_t offset = 0;               // of its first value in the rank's plane
};
InnerRows inner_rows(const Domain& domain, const Domain& solved, const fft::SlabShare& share);

} // namespace shearwake::layered
