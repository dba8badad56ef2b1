// SPDX-License-Identifier: BSD-3-Clause
#include "fft/run_transform.hpp"
#include "support/worst.hpp"

#include <algorithm>
#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

namespace test_slab_transform {

using namespace shearwake;

/// Extents that are not divisible, odd extents, and fewer rows than ranks.
using PlaneSize = std::pair<std::ptrdiff_t, std::ptrdiff_t>;
const auto grids = {PlaneSize{14, 10}, PlaneSize{30, 18}, PlaneSize{9, 7},
                    PlaneSize{4, 2},   PlaneSize{2, 6},   PlaneSize{1, 6}};

/// Pseudo-random numbers that depend on the position in the grid, not on the rank.
static double noise(std::ptrdiff_t i, std::ptrdiff_t j) {
    const auto x = static_cast<double>(i), y = static_cast<double>(j);
    return std::sin(12.9898 * x + 78.233 * y + 3.1 * x * y + 1.0);
}

/// A plane of noise in its rows, with arbitrary values in the padding.
static fft::AlignedVector<double> noise_plane(const fft::SlabShare& share, std::ptrdiff_t ny,
                                              std::ptrdiff_t seed = 0) {
    fft::AlignedVector<double> plane(static_cast<std::size_t>(share.reals), 1e3);
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < ny; ++j)
            plane[static_cast<std::size_t>(i * share.padded_ny + j)] =
                noise(share.x_start + i, j + seed);
    return plane;
}

static std::complex<double>* spectrum_of(fft::AlignedVector<double>& plane) {
    return reinterpret_cast<std::complex<double>*>(plane.data());
}

TEST_CASE("slab transform equals the Fourier sum for all ranks and extents", "[mpi]") {
    const auto [nx, ny] = GENERATE(values(grids));
    const Comm world = Comm::world();
    const fft::SlabTransform transform(nx, ny, world);
    const fft::SlabShare& share = transform.share();
    fft::AlignedVector<double> plane = noise_plane(share, ny);
    transform.to_spectral(plane.data());
    const auto turns = [](std::ptrdiff_t product, std::ptrdiff_t points) {
        return static_cast<double>(product % points) / static_cast<double>(points);
    };
    double worst = 0.0;
    for (std::ptrdiff_t k = 0; k < share.ky_count * nx; ++k) {
        std::complex<double> sum = 0.0;
        for (std::ptrdiff_t i = 0; i < nx; ++i)
            for (std::ptrdiff_t j = 0; j < ny; ++j)
                sum += std::polar(1.0, -2.0 * std::numbers::pi *
                                           (turns(k % nx * i, nx) +
                                            turns((share.ky_start + k / nx) * j, ny))) *
                       noise(i, j);
        worst = test::worse(worst, std::abs(spectrum_of(plane)[k] - sum));
    }
    CHECK(world.max(worst) / static_cast<double>(nx * ny) < 1e-15); // rounding errors of a sum
    CHECK(world.sum(static_cast<double>(share.x_count)) == static_cast<double>(nx));
    CHECK(world.sum(static_cast<double>(share.ky_count)) == static_cast<double>(ny / 2 + 1));
}

TEST_CASE("rows below the Nyquist frequency are distributed evenly", "[mpi]") {
    const auto [nx, ny] = GENERATE(values(grids));
    const Comm world = Comm::world();
    const fft::SlabShare share = fft::SlabTransform(nx, ny, world).share();
    const std::ptrdiff_t below = (ny + 1) / 2, ranks = world.size(),
                         block = (below + ranks - 1) / ranks;
    std::ptrdiff_t mine = 0;
    for (std::ptrdiff_t k = 0; k < share.ky_count; ++k)
        if (2 * (share.ky_start + k) != ny) ++mine;
    CHECK(mine == std::clamp<std::ptrdiff_t>(below - world.rank() * block, 0, block));
    // The row at this frequency belongs to the rank with the last of the others.
    CHECK((share.ky_count == mine || share.ky_start + mine == below));
    CHECK(world.max(static_cast<int>(share.ky_count)) == fft::most_rows(ny, world.size()));
}

TEST_CASE("forward and backward transforms are adjoint", "[mpi]") {
    const auto [nx, ny] = GENERATE(values(grids));
    const Comm world = Comm::world();
    const fft::SlabTransform transform(nx, ny, world);
    const fft::SlabShare& share = transform.share();
    fft::AlignedVector<double> spectrum(static_cast<std::size_t>(share.reals));
    for (std::ptrdiff_t j = 0; j < share.ky_count; ++j)
        for (std::ptrdiff_t i = 0; i < nx; ++i)
            spectrum_of(spectrum)[j * nx + i] = {noise(i, share.ky_start + j),
                                                 noise(i + 1000, share.ky_start + j)};
    fft::AlignedVector<double> real = noise_plane(share, ny);
    fft::AlignedVector<double> real_of_spectrum = spectrum, spectrum_of_real = real;
    transform.to_physical(real_of_spectrum.data());
    transform.to_spectral(spectrum_of_real.data());
    double in_space = 0.0, in_modes = 0.0;
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < ny; ++j) {
            const auto at = static_cast<std::size_t>(i * share.padded_ny + j);
            in_space += real_of_spectrum[at] * real[at];
        }
    for (std::ptrdiff_t j = 0; j < share.ky_count; ++j) {
        // Rows that also represent their mirror image count twice.
        const std::ptrdiff_t ky = share.ky_start + j;
        const double weight = ky == 0 || 2 * ky == ny ? 1.0 : 2.0;
        for (std::ptrdiff_t i = 0; i < nx; ++i)
            in_modes += weight * std::real(std::conj(spectrum_of(spectrum_of_real)[j * nx + i]) *
                                           spectrum_of(spectrum)[j * nx + i]);
    }
    // Both are sums of nx ny products of numbers up to about sqrt(nx ny).
    const double size = std::pow(static_cast<double>(nx * ny), 1.5);
    CHECK(std::abs(world.sum(in_space) - world.sum(in_modes)) / size < 1e-14);
}

TEST_CASE("transform of runs equals that of a plane with zeros elsewhere", "[mpi]") {
    const auto [nx, ny] =
        GENERATE(values(grids), PlaneSize{66, 18}); // the last one: eight rows at once
    const bool is_window = GENERATE(true, false);   // the runs of all ranks end before the row
    const Comm world = Comm::world();
    const fft::SlabTransform transform(nx, ny, world);
    const fft::SlabShare& share = transform.share();
    // Incomplete groups of rows, a row without runs, two runs in one row, and no runs on a rank
    // with a single row.
    std::vector<fft::RowRun> runs;
    std::size_t cells = 0;
    for (std::ptrdiff_t i = share.x_count / 3; i < share.x_count - share.x_count / 2; ++i) {
        if (i == share.x_count / 3 + 1) continue;
        for (const auto& [begin, end] : {std::pair{is_window ? ny / 4 : 0, ny / 3 + 1},
                                         std::pair{ny / 2 + 1, is_window ? ny - 1 : ny}}) {
            if (begin >= end) continue;
            runs.push_back({i, begin, end, cells});
            cells += static_cast<std::size_t>(end - begin);
        }
    }
    fft::AlignedVector<double> plane = noise_plane(share, ny, 3);
    std::vector<double> given(cells);
    const fft::AlignedVector<double> noise = plane;
    std::fill(plane.begin(), plane.end(), 0.0);
    for (const fft::RowRun& run : runs)
        for (std::ptrdiff_t j = run.begin; j < run.end; ++j) {
            const auto at = static_cast<std::size_t>(run.row * share.padded_ny + j);
            plane[at] = given[run.offset + static_cast<std::size_t>(j - run.begin)] = noise[at];
        }
    // Two planes at once, the second one doubled.
    const fft::RunTransform only(transform, world, runs);
    std::vector<double> both = given, back(2 * cells, 0.0);
    for (const double value : given)
        both.push_back(2.0 * value);
    fft::AlignedVector<double> lines(2 * static_cast<std::size_t>(transform.lines_reals()), 7.0);
    only.to_lines(both.data(), cells, 2, lines.data());
    transform.to_spectral(plane.data());
    double worst = 0.0;
    for (std::ptrdiff_t k = 0; k < share.ky_count; ++k) {
        double* line = lines.data() + 2 * k * transform.line_pitch();
        double* second = line + transform.lines_reals();
        transform.line_to_spectral(line);
        transform.line_to_spectral(second);
        for (std::ptrdiff_t at = 0; at < 2 * nx; ++at)
            worst = test::worse(
                worst, std::abs(line[at] - plane[static_cast<std::size_t>(2 * k * nx + at)]));
        for (std::ptrdiff_t at = 0; at < 2 * nx; ++at)
            CHECK(second[at] == 2.0 * line[at]); // exact: a power of two
        transform.line_to_physical(line);
        transform.line_to_physical(second);
    }
    // Sums of nx ny numbers of at most 1, with different plans along x.
    const double size = std::sqrt(static_cast<double>(nx * ny));
    CHECK(world.max(worst) < 1e-14 * size);
    only.to_values(lines.data(), 2, back.data(), cells);
    worst = 0.0;
    for (std::size_t i = 0; i < 2 * cells; ++i)
        worst = test::worse(worst, std::abs(back[i] / static_cast<double>(nx * ny) - both[i]));
    CHECK(world.max(worst) < 1e-14);
}

TEST_CASE("planes with different runs are transformed together as each alone", "[mpi]") {
    const Comm world = Comm::world();
    const std::ptrdiff_t nx = 30, ny = 18;
    const fft::SlabTransform transform(nx, ny, world);
    const fft::SlabShare& share = transform.share();
    // Runs in rows 3 to 25, in row 8 only, and in no row: on most ranks some planes have none.
    const std::pair<std::ptrdiff_t, std::ptrdiff_t> rows[] = {{3, 26}, {8, 9}, {0, 0}};
    std::vector<std::vector<fft::RowRun>> run_sets;
    std::vector<fft::RunTransform::Plane> planes;
    std::vector<double> given;
    for (const auto& [begin, end] : rows) {
        planes.push_back({run_sets.size(), given.size()});
        std::size_t cells = 0;
        std::vector<fft::RowRun>& runs = run_sets.emplace_back();
        for (std::ptrdiff_t i = 0; i < share.x_count; ++i) {
            if (share.x_start + i < begin || share.x_start + i >= end) continue;
            runs.push_back({i, 4, 11, cells});
            for (std::ptrdiff_t j = 4; j < 11; ++j)
                given.push_back(noise(share.x_start + i + 40 * std::ssize(run_sets), j));
            cells += 7;
        }
    }
    const fft::RunTransform::Layout layout{{share.ky_start, share.ky_count},
                                           share.x_start,
                                           nx,
                                           transform.line_pitch(),
                                           transform.lines_reals()};
    const fft::RunTransform all(transform, world, run_sets, layout);
    const auto reals = static_cast<std::size_t>(transform.lines_reals());
    fft::AlignedVector<double> together(3 * reals, 7.0);
    std::vector<double> back(given.size());
    all.to_lines(given.data(), planes, together.data());
    all.to_values(together.data(), planes, back.data());
    for (std::size_t p = 0; p < 3; ++p) {
        // A window of the same columns, so that the same sums are computed.
        std::vector<std::vector<fft::RowRun>> both = {run_sets[p], run_sets[0]};
        const fft::RunTransform one(transform, world, both, layout);
        const std::vector<fft::RunTransform::Plane> plane = {{0, planes[p].first}};
        fft::AlignedVector<double> alone(reals, 7.0);
        std::vector<double> again(given.size());
        one.to_lines(given.data(), plane, alone.data());
        one.to_values(alone.data(), plane, again.data());
        for (std::ptrdiff_t k = 0; k < share.ky_count; ++k)
            for (std::ptrdiff_t at = 2 * k * transform.line_pitch();
                 at < 2 * (k * transform.line_pitch() + nx); ++at)
                CHECK(alone[static_cast<std::size_t>(at)] ==
                      together[p * reals + static_cast<std::size_t>(at)]);
        const std::size_t end = p < 2 ? planes[p + 1].first : given.size();
        for (std::size_t i = planes[p].first; i < end; ++i)
            CHECK(again[i] == back[i]);
    }
    // The line transforms along x are left out: those along y alone multiply by ny.
    double worst = 0.0;
    for (std::size_t i = 0; i < given.size(); ++i)
        worst = test::worse(worst, std::abs(back[i] / static_cast<double>(ny) - given[i]));
    CHECK(world.max(worst) < 1e-14); // some rounding errors of numbers of order 1
}

TEST_CASE("transforms have the same bits on a team and on one rank", "[mpi]") {
    const auto [nx, ny] = GENERATE(values(grids));
    const Comm world = Comm::world();
    const fft::SlabTransform transform(nx, ny, world);
    const fft::SlabTransform whole(nx, ny, world.split(world.rank()));
    const fft::SlabShare& share = transform.share();
    fft::AlignedVector<double> mine = noise_plane(share, ny), all = noise_plane(whole.share(), ny);
    transform.to_spectral(mine.data());
    whole.to_spectral(all.data());
    double worst = 0.0;
    for (std::ptrdiff_t i = 0; i < share.ky_count * nx; ++i)
        worst = test::worse(
            worst, std::abs(spectrum_of(mine)[i] - spectrum_of(all)[share.ky_start * nx + i]));
    transform.to_physical(mine.data());
    whole.to_physical(all.data());
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i)
        for (std::ptrdiff_t j = 0; j < ny; ++j) {
            const std::ptrdiff_t at = i * share.padded_ny + j;
            const std::ptrdiff_t in_all = at + share.x_start * share.padded_ny;
            worst = test::worse(worst, std::abs(mine[static_cast<std::size_t>(at)] -
                                                all[static_cast<std::size_t>(in_all)]));
        }
    CHECK(world.max(worst) == 0.0); // every line uses the same plan on any rank
}

} // namespace test_slab_transform
