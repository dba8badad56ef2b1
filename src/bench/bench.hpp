// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

#include <string>
#include <vector>

namespace shearwake::bench {

struct BenchArguments {
    std::string engine = "layered";
    std::vector<std::ptrdiff_t> grid; // three numbers; empty: the default of the engine
    std::string device = "cpu";       // of pstd, or gpu
    int gpu = -1;                     // its number; -1: the first
    bool json = false;                // print a document instead of text
};

/// Measures the time of a case or of a step and that of its FFTs alone. Collective.
ExitCode bench_command(const BenchArguments& arguments, const Comm& world);

/// Three layers of skin on 256 x 192 points, a 3 mm focus at 7 m/s, 280 frames.
Case layered_bench_case();

} // namespace shearwake::bench
