// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/error.hpp"
#include "base/units.hpp"
#include "parallel/comm.hpp"
#include "problem/case/case.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

namespace shearwake::bench {

/// One number of a benchmark.
struct Measurement {
    std::string name;
    double value = 0.0;
    std::string unit;
};

/// Collects the measurements of a benchmark, and prints its text unless a document is wanted.
class Output {
public:
    enum class Form { text, document };
    explicit Output(Form form) : form_(form) {}

    template <class... Arguments>
    void print(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
        if (form_ == Form::text) fmt::print(format, std::forward<Arguments>(arguments)...);
    }
    /// Adds a measurement to the document. Call it on rank 0.
    void add(std::string name, double value, std::string unit) {
        measurements_.push_back({std::move(name), value, std::move(unit)});
    }
    const std::vector<Measurement>& measurements() const { return measurements_; }

private:
    Form form_;
    std::vector<Measurement> measurements_;
};

struct BenchArguments {
    std::string engine = "layered";
    // `spectral` and `pstd`:
    std::string grid; // points along x and y, then levels or points; empty: the engine's default
    int steps = 20;
    // `spectral`:
    double contrast = 4.0;  // shear stiffness of the body relative to the layer; 1: no body
    double sponge_mm = 0.0; // on each side
    bool rigid = false;     // a rigid cylinder instead of the body
    bool json = false;      // print a document instead of text
};

/// The command `bench`. Collective.
ExitCode bench_command(const BenchArguments& arguments, const Comm& world);

// Functions that several benchmarks use. All are collective.

/// Wall-clock seconds of the slowest rank.
double seconds_of(const Comm& world, const auto& work) {
    world.barrier();
    const auto began = Clock::now();
    work();
    return world.max(seconds_since(began));
}

/// The best of several measurements, which is the least disturbed by other processes.
double best_of(int times, const auto& measure) {
    double best = measure();
    for (int i = 1; i < times; ++i)
        best = std::min(best, measure());
    return best;
}

/// Bytes per second that all ranks together read and write when all of them copy memory.
double copy_rate_B_s(const Comm& world);

/// The case of `bench layered`: three layers of skin, a focus at 7 m/s.
Case layered_bench_case();
/// The same layers in the periodic regime: a circle drawn 100 times per second with AM.
Case steady_bench_case();

/// Measures the time of a step and its phases for a layer with or without a body, and compares it
/// with lower bounds set by FFTs and memory bandwidth.
ExitCode bench_spectral(const BenchArguments& arguments, const Comm& world, Output& out);
/// Measures the steps of the pseudospectral scheme in single and double precision, with and without
/// losses, and compares them with a lower bound.
ExitCode bench_pstd(const BenchArguments& arguments, const Comm& world, Output& out);
} // namespace shearwake::bench
