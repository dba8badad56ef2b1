// SPDX-License-Identifier: BSD-3-Clause
#include "base/error.hpp"
#include "engines/spectral/depth/vertical_operator.hpp"
#include "engines/spectral/kernels/strains.hpp"
#include "engines/spectral/kernels/symmetric.hpp"
#include "engines/spectral/kernels/transfer.hpp"
#include "measures/kernels/row_sums.hpp"
#include "neural/kernels/neuron.hpp"
#include "unit/simd/random_numbers.hpp"

#include <catch2/catch.hpp>

#include <cmath>

namespace test_kernels {

// Compares every kernel that this CPU supports with a plain loop and thereby with each other.

using namespace shearwake;
using simd::InstructionSet;

static std::vector<Block> random_blocks(std::size_t count, unsigned seed) {
    const std::vector<double> numbers =
        test::random_numbers<std::vector<double>>(count * lane_count, seed);
    std::vector<Block> blocks(count);
    std::copy(numbers.begin(), numbers.end(), scalars(blocks.data()));
    return blocks;
}

TEST_CASE("converts instruction sets to names and rejects other names", "[simd]") {
    for (const auto set : {InstructionSet::baseline, InstructionSet::avx2, InstructionSet::avx512})
        CHECK(simd::instruction_set_named(simd::name_of(set)) == set);
    CHECK_FALSE(simd::instruction_set_named("sse9"));
    CHECK_FALSE(simd::instruction_set_named(""));
}

TEST_CASE("rejects an instruction set that the CPU does not support", "[simd]") {
    if (simd::best_instruction_set() == InstructionSet::avx512) return; // all are supported
    CHECK_THROWS_AS(simd::use_instruction_set(InstructionSet::avx512), UsageError);
}

TEST_CASE("sums over a row equal those of a plain loop for all lengths and vector widths",
          "[simd]") {
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        for (const std::size_t count : {0u, 1u, 7u, 8u, 9u, 31u, 192u}) {
            const std::vector<double> values = test::random_numbers<std::vector<double>>(count, 1);
            measures::RowSums8 sums;
            simd::kernels<measures::RowSumKernels>(set).row_sums(values.data(), std::ssize(values),
                                                                 sums);
            double u = 0.0, abs_u = 0.0, u2 = 0.0, u4 = 0.0, peak = 0.0;
            for (const double value : values) {
                u += value;
                abs_u += std::abs(value);
                u2 += value * value;
                u4 += std::pow(value, 4);
                peak = std::max(peak, std::abs(value));
            }
            // Up to 192 numbers of order 1, added in a different order.
            CHECK(sum_of(sums.u) == Approx(u).margin(1e-13));
            CHECK(sum_of(sums.abs_u) == Approx(abs_u).epsilon(1e-14));
            CHECK(sum_of(sums.u2) == Approx(u2).epsilon(1e-14));
            CHECK(sum_of(sums.u4) == Approx(u4).epsilon(1e-14));
            CHECK(*std::ranges::max_element(sums.peak.lane) == peak);
        }
    }
}

TEST_CASE("sums of delayed lines equal those of a plain loop", "[simd][neural]") {
    constexpr std::size_t samples = 203; // not a multiple of any chunk
    const std::vector<double> values = test::random_numbers<std::vector<double>>(5 * samples, 2);
    std::vector<neural::DelayedLine> lines;
    for (const std::ptrdiff_t delay : {0, 1, 64, 150, 500})
        lines.push_back({values.data() + lines.size() * samples, delay,
                         0.5 + static_cast<double>(lines.size())});
    std::vector<double> expected(samples, 0.0);
    for (const auto& line : lines)
        for (auto k = static_cast<std::size_t>(line.delay); k < samples; ++k)
            expected[k] += line.gain * line.values[k - static_cast<std::size_t>(line.delay)];
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        std::vector<double> sum(samples, 7.0); // overwritten
        simd::kernels<neural::NeuronKernels>(set).sum_delayed(lines.data(), std::ssize(lines),
                                                              samples, sum.data());
        for (std::size_t k = 0; k < samples; ++k)
            CHECK(sum[k] == Approx(expected[k]).margin(1e-14));
    }
}

TEST_CASE("skyline factors solve their matrix at all vector widths", "[simd][spectral]") {
    constexpr std::ptrdiff_t levels = 11, degree = 4, per_level = 2;
    const spectral::SkylineMatrix matrix(levels, degree, per_level);
    const spectral::SkylineRows rows = matrix.rows();
    std::vector<Block> entries = random_blocks(static_cast<std::size_t>(matrix.entries()), 3);
    for (std::ptrdiff_t i = 0; i < rows.count; ++i) // diagonally dominant, hence positive definite
        for (double& lane : entries[static_cast<std::size_t>(rows.row[i].start + i)].lane)
            lane = 20.0 + lane;
    const auto x = random_blocks(static_cast<std::size_t>(rows.count * spectral::parts), 4);
    std::vector<Block> b(x.size(), Block{});
    for (std::ptrdiff_t i = 0; i < rows.count; ++i)
        for (std::ptrdiff_t j = rows.row[i].first; j <= i; ++j) {
            const Block& a = entries[static_cast<std::size_t>(rows.row[i].start + j)];
            for (std::ptrdiff_t p = 0; p < spectral::parts; ++p)
                for (std::ptrdiff_t l = 0; l < lane_count; ++l) {
                    const auto at = [&](std::ptrdiff_t row) {
                        return static_cast<std::size_t>(row * spectral::parts + p);
                    };
                    b[at(i)][l] += a[l] * x[at(j)][l];
                    if (j < i) b[at(j)][l] += a[l] * x[at(i)][l];
                }
        }
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        const spectral::SkylineKernels& kernels = simd::kernels<spectral::SkylineKernels>(set);
        std::vector<Block> factor = entries, solution = b;
        kernels.factorise(rows, factor.data());
        kernels.solve(rows, factor.data(), solution.data());
        double worst = 0.0;
        for (std::size_t i = 0; i < x.size(); ++i)
            for (std::ptrdiff_t l = 0; l < lane_count; ++l)
                worst = std::max(worst, std::abs(solution[i][l] - x[i][l]));
        CHECK(worst < 1e-13); // condition number of about 3, numbers of order 1
    }
}

TEST_CASE("transfers of strain and force are adjoint at all vector widths", "[simd][spectral]") {
    // (E u, s) = (u, E* s) for all u and s, including lines with incomplete blocks.
    constexpr std::ptrdiff_t nodes = 4, levels = 6, nx = 20;
    const std::vector<double> derivative =
        test::random_numbers<std::vector<double>>(nodes * nodes, 5);
    const spectral::TransferPoint points[] = {{0, 1, 2.0}, {3, 3, 3.0}};
    const spectral::TransferArrays arrays = {
        nodes, levels, 2, points, derivative.data(), spectral::all_components};
    const std::ptrdiff_t planes = 2 * spectral::all_components, stride = 2 * nx;
    for (const auto set : test::sets_of_this_processor()) {
        const spectral::TransferKernels& kernels = simd::kernels<spectral::TransferKernels>(set);
        for (const std::ptrdiff_t block : {0, 1}) {
            INFO(simd::name_of(set) << ", block " << block);
            spectral::WaveBlock waves{.kx = {}, .k = {}, .ky = 0.7, .first = 8 * block, .nx = nx};
            for (std::ptrdiff_t l = 0; l < lane_count; ++l) {
                waves.kx[l] = 0.3 * static_cast<double>(waves.first + l);
                waves.k[l] = std::hypot(waves.kx[l], waves.ky);
            }
            std::vector<Block> u = random_blocks(3 * levels * spectral::parts, 6);
            for (std::size_t i = 0; i < u.size(); ++i)
                for (std::ptrdiff_t l = 0; l < lane_count; ++l) {
                    const bool is_minus = i % spectral::parts >= spectral::minus_re;
                    const std::ptrdiff_t kx = waves.first + l;
                    if (2 * kx >= nx || (is_minus && kx == 0)) u[i][l] = 0.0;
                }
            std::vector<double> strain(static_cast<std::size_t>(planes * stride), 0.0);
            kernels.strain(arrays, waves, u.data(), strain.data(), stride);
            const std::vector<double> stress =
                test::random_numbers<std::vector<double>>(strain.size(), 7);
            std::vector<Block> force(u.size(), Block{});
            kernels.add_force(arrays, waves, stress.data(), stride, -1.0, force.data());
            double in_lines = 0.0, in_pencils = 0.0;
            for (std::size_t i = 0; i < strain.size(); ++i)
                in_lines += strain[i] * stress[i];
            for (std::size_t i = 0; i < u.size(); ++i)
                for (std::ptrdiff_t l = 0; l < lane_count; ++l)
                    in_pencils += u[i][l] * force[i][l];
            CHECK(in_lines == Approx(in_pencils).epsilon(1e-12)); // 1000 numbers of order 1
        }
    }
}

TEST_CASE("products of strains have the same bits at all vector widths with fused multiply-add",
          "[simd]") {
    if (simd::best_instruction_set() < InstructionSet::avx512) return; // nothing to compare
    const std::vector<double> a = test::random_numbers<std::vector<double>>(1003, 8),
                              b = test::random_numbers<std::vector<double>>(1003, 9);
    const auto product = [&](InstructionSet set) {
        return simd::kernels<spectral::StrainKernels>(set).product(1003, a.data(), b.data());
    };
    CHECK(product(InstructionSet::avx2) == product(InstructionSet::avx512));
}

TEST_CASE("products with symmetric matrices equal those of a plain loop", "[simd]") {
    using namespace spectral;
    for (const std::size_t unknowns : {1u, 2u, 5u, 8u, 27u}) {
        const std::size_t entries = unknowns * (unknowns + 1) / 2;
        const std::vector<double> numbers =
            test::random_numbers<std::vector<double>>(entries * lane_count, 3);
        std::vector<float> high(numbers.begin(), numbers.end()), low;
        for (std::size_t n = 0; n < numbers.size(); ++n)
            low.push_back(static_cast<float>(numbers[n] - static_cast<double>(high[n])));
        const std::vector<Block> x = random_blocks(unknowns * parts, 4);
        const auto expected = [&](std::size_t i, std::size_t p, std::size_t lane, bool rounded) {
            double sum = 0.0;
            for (std::size_t j = 0; j < unknowns; ++j) {
                const std::size_t row = std::max(i, j), column = std::min(i, j);
                const std::size_t at = (row * (row + 1) / 2 + column) * lane_count + lane;
                sum += (rounded ? static_cast<double>(high[at]) : numbers[at]) *
                       x[j * parts + p].lane[lane];
            }
            return sum;
        };
        for (const auto set : test::sets_of_this_processor()) {
            INFO(simd::name_of(set) << ", " << unknowns << " unknowns");
            const auto& kernels = simd::kernels<SymmetricKernels>(set);
            for (const bool rounded : {false, true}) {
                std::vector<Block> y = random_blocks(unknowns * parts, 5); // to be overwritten
                (rounded ? kernels.multiply_rounded : kernels.multiply)(
                    std::ssize(x) / parts, {high.data(), low.data()}, x.data(), y.data());
                for (std::size_t i = 0; i < unknowns; ++i)
                    for (std::size_t p = 0; p < parts; ++p)
                        for (std::size_t lane = 0; lane < lane_count; ++lane)
                            // 27 products of order 1; an entry of two floats has 49 bits.
                            CHECK(y[i * parts + p].lane[lane] ==
                                  Approx(expected(i, p, lane, rounded)).margin(1e-13));
            }
        }
    }
}

} // namespace test_kernels
