// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/kernels/update.hpp"
#include "fft/aligned.hpp"
#include "fft/kernels/staggered.hpp"
#include "unit/simd/random_numbers.hpp"

#include <catch2/catch.hpp>

#include <algorithm>
#include <complex>
#include <limits>

namespace test_pstd_kernels {

// The kernels of engine pstd, every one that this processor can run, against plain loops.

using namespace shearwake;

template <class Real>
fft::AlignedVector<Real> random_reals(std::size_t count, unsigned seed) {
    return test::random_numbers<fft::AlignedVector<Real>>(count, seed);
}

/// Of sums of a few products of numbers of order 1.
template <class Real>
constexpr double rounding = 20.0 * std::numeric_limits<Real>::epsilon();

/// Four runs as SplitRuns makes them, by the axis of their layer, and what is between them.
constexpr std::ptrdiff_t nz = 77; // no multiple of any vector
const std::vector<pstd::SplitRun> runs = {
    {3, 13, 0, 0, -1}, {16, 25, 10, 10, 0}, {25, 41, 19, 10, 1}, {60, 76, 35, 10, 2}};
constexpr std::ptrdiff_t kept = 51; // values in the runs

/// A field of `parts` parts, along axes 0, 1, 2, in a row with layers.
template <class Real>
struct FieldInLayers {
    std::ptrdiff_t parts;
    fft::AlignedVector<Real> total = random_reals<Real>(nz, 1);
    fft::AlignedVector<Real> first = random_reals<Real>(kept, 2),
                             second = random_reals<Real>(kept, 3);
    fft::AlignedVector<Real> z[3] = {random_reals<Real>(nz, 4), random_reals<Real>(nz, 5),
                                     random_reals<Real>(nz, 6)};

    pstd::FieldRow<Real> row() {
        return {.nz = nz,
                .total = total.data(),
                .part = {first.data(), second.data()},
                .factor = {{Real(0.9), z[0].data()},
                           {Real(0.8), z[1].data()},
                           {Real(0.7), z[2].data()}},
                .axes = {0, 1, 2},
                .first_run = runs.data(),
                .last_run = runs.data() + runs.size()};
    }
    Real factor(std::size_t part, std::ptrdiff_t at) {
        return row().factor[part].xy * z[part][static_cast<std::size_t>(at)];
    }
    /// The update with the parts one by one.
    void update(const auto& rate) {
        const auto move = [&](std::size_t part, std::ptrdiff_t at, Real value, Real by) {
            const Real q = factor(part, at);
            return q * (q * value + by);
        };
        for (std::ptrdiff_t i = 0; i < nz; ++i) {
            Real& sum = total[static_cast<std::size_t>(i)];
            Real r[3] = {rate(0, i), rate(1, i), parts == 3 ? rate(2, i) : Real(0)};
            const auto run = std::find_if(runs.begin(), runs.end(), [&](const pstd::SplitRun& of) {
                return i >= of.begin && i < of.end;
            });
            if (run == runs.end()) {
                sum += r[0] + r[1] + r[2];
                continue;
            }
            Real& a = first[static_cast<std::size_t>(run->offset + i - run->begin)];
            if (run->face < 0 && parts == 3) {
                Real& b = second[static_cast<std::size_t>(run->second + i - run->begin)];
                const Real rest = move(0, i, sum - a - b, r[0]);
                a = move(1, i, a, r[1]);
                b = move(2, i, b, r[2]);
                sum = rest + a + b;
            } else if (run->face == 2 && parts == 2) { // the layer of another axis: all as one
                sum = move(0, i, sum, r[0] + r[1]);
            } else {
                const std::size_t own = run->face < 0 ? 1 : static_cast<std::size_t>(run->face);
                const Real rest = move(own == 0 ? 1 : 0, i, sum - a, r[0] + r[1] + r[2] - r[own]);
                a = move(own, i, a, r[own]);
                sum = rest + a;
            }
        }
    }
};

template <class Real>
double worst_difference(const fft::AlignedVector<Real>& a, const fft::AlignedVector<Real>& b) {
    double worst = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i)
        worst = std::max(worst, std::abs(static_cast<double>(a[i]) - static_cast<double>(b[i])));
    return worst;
}

template <class Real>
void check_same(const FieldInLayers<Real>& a, const FieldInLayers<Real>& b) {
    CHECK(worst_difference(a.total, b.total) < rounding<Real>);
    CHECK(worst_difference(a.first, b.first) < rounding<Real>);
    CHECK(worst_difference(a.second, b.second) < rounding<Real>);
}

TEMPLATE_TEST_CASE("velocities and their accelerations are updated as by a plain loop",
                   "[simd][pstd]", double, float) {
    using Real = TestType;
    const auto c = random_reals<Real>(nz, 7);
    const fft::AlignedVector<Real> g[3] = {random_reals<Real>(nz, 8), random_reals<Real>(nz, 9),
                                           random_reals<Real>(nz, 10)};
    const auto rate = [&](std::size_t part, std::ptrdiff_t at) {
        const auto i = static_cast<std::size_t>(at);
        return c[i] * g[part][i];
    };
    FieldInLayers<Real> expected{3};
    expected.update(rate);
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        FieldInLayers<Real> field{3};
        fft::AlignedVector<Real> acceleration(nz), sum(nz);
        for (std::ptrdiff_t i = 0; i < nz; ++i)
            sum[static_cast<std::size_t>(i)] = rate(0, i) + rate(1, i) + rate(2, i);
        const Real* const pointers[3] = {g[0].data(), g[1].data(), g[2].data()};
        simd::kernels<pstd::UpdateKernels<Real>>(set).velocity(field.row(), c.data(), pointers,
                                                               acceleration.data());
        check_same(field, expected);
        CHECK(worst_difference(acceleration, sum) < rounding<Real>);
    }
}

TEMPLATE_TEST_CASE("stresses are updated as by a plain loop", "[simd][pstd]", double, float) {
    using Real = TestType;
    const bool lossy = GENERATE(false, true);
    const std::ptrdiff_t parts = GENERATE(2, 3);
    std::vector<fft::AlignedVector<Real>> values;
    for (unsigned i = 0; i < 12; ++i)
        values.push_back(random_reals<Real>(nz, 20 + i));
    const auto value = [&](std::size_t number, std::ptrdiff_t at) {
        return values[number][static_cast<std::size_t>(at)];
    };
    FieldInLayers<Real> expected{parts};
    expected.update([&](std::size_t part, std::ptrdiff_t at) {
        const Real elastic = value(4 * part, at) * value(4 * part + 1, at);
        return lossy ? elastic + value(4 * part + 2, at) * value(4 * part + 3, at) : elastic;
    });
    pstd::Rate<Real> rates[3];
    for (std::size_t part = 0; part < 3; ++part)
        rates[part] = {values[4 * part].data(), values[4 * part + 1].data(),
                       values[4 * part + 2].data(), values[4 * part + 3].data()};
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set) << ", parts: " << parts << ", lossy: " << lossy);
        const pstd::UpdateKernels<Real>& kernels = simd::kernels<pstd::UpdateKernels<Real>>(set);
        FieldInLayers<Real> field{parts};
        if (parts == 3)
            (lossy ? kernels.normal_lossy : kernels.normal)(field.row(), rates);
        else
            (lossy ? kernels.shear_lossy : kernels.shear)(field.row(), rates);
        check_same(field, expected);
    }
}

TEMPLATE_TEST_CASE("spectra are multiplied, and lines joined and parted, as by a plain loop",
                   "[simd][pstd]", double, float) {
    using Real = TestType;
    constexpr std::size_t points = 37, lines = 3;
    const auto re = random_reals<Real>(points, 1), im = random_reals<Real>(points, 2);
    const auto factor = random_reals<Real>(2 * points, 3);
    fft::AlignedVector<Real> real(2 * points), imaginary(2 * points);
    for (std::size_t m = 0; m < points; ++m) {
        real[2 * m] = real[2 * m + 1] = factor[2 * m];
        imaginary[2 * m] = -factor[2 * m + 1];
        imaginary[2 * m + 1] = factor[2 * m + 1];
    }
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        const auto& kernels = simd::kernels<fft::StaggeredKernels<Real>>(set);
        fft::AlignedVector<Real> spectra(2 * points * lines), back_re(points), back_im(points);
        for (std::size_t l = 0; l < lines; ++l)
            kernels.join(re.data(), im.data(), points, spectra.data() + 2 * points * l);
        kernels.part(spectra.data() + 2 * points * (lines - 1), points, back_re.data(),
                     back_im.data());
        CHECK(back_re == re);
        CHECK(back_im == im);
        kernels.multiply(spectra.data(), real.data(), imaginary.data(), points, lines);
        double worst = 0.0;
        for (std::size_t i = 0; i < points * lines; ++i) {
            const std::size_t m = i % points;
            const auto product = std::complex<double>(re[m], im[m]) *
                                 std::complex<double>(factor[2 * m], factor[2 * m + 1]);
            worst = std::max(worst, std::abs(product - std::complex<double>(spectra[2 * i],
                                                                            spectra[2 * i + 1])));
        }
        CHECK(worst < rounding<Real>);
    }
}

TEMPLATE_TEST_CASE("rows of a block are copied whole and nothing beside them", "[simd][pstd]",
                   double, float) {
    using Real = TestType;
    constexpr auto width = static_cast<std::size_t>(fft::row_bytes) / sizeof(Real);
    constexpr std::size_t pitch = 3 * width, rows = 5;
    const auto from = random_reals<Real>(rows * width, 1);
    for (const auto set : test::sets_of_this_processor()) {
        INFO(simd::name_of(set));
        const auto& kernels = simd::kernels<fft::StaggeredKernels<Real>>(set);
        for (const auto move : {kernels.copy_rows, kernels.stream_rows}) {
            fft::AlignedVector<Real> to(rows * pitch, Real(7));
            move(from.data(), width, rows, to.data() + width, pitch);
            fft::AlignedVector<Real> expected(rows * pitch, Real(7));
            for (std::size_t r = 0; r < rows; ++r)
                std::copy_n(from.data() + r * width, width, expected.data() + r * pitch + width);
            CHECK(to == expected);
        }
    }
}

} // namespace test_pstd_kernels
