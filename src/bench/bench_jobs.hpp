// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <string>
#include <vector>

namespace shearwake::bench {

/// A case of `bench estimates` and its name in the table.
struct BenchJob {
    std::string name;
    Case physics;
};

/// Twelve cases of all engines, about 0.1 to 10 s each: small and large grids, bodies, a map,
/// receptors, volumes and a grid study.
std::vector<BenchJob> bench_jobs();

} // namespace shearwake::bench
