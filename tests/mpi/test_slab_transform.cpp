#include "fft/slab_transform.hpp"
#include "support/worst.hpp"

#include <catch2/catch.hpp>
#include <cmath>
#include <numbers>

using namespace shearwake;

TEST_CASE("the slab transform is the Fourier sum, whatever the ranks and extents", "[mpi]") {
    // Extents that do not divide, and one with fewer rows than ranks: surplus ranks join in.
    const auto [nx, ny] = GENERATE(std::pair<std::ptrdiff_t, std::ptrdiff_t>{14, 10},
                                   std::pair<std::ptrdiff_t, std::ptrdiff_t>{30, 18},
                                   std::pair<std::ptrdiff_t, std::ptrdiff_t>{4, 2});
    const Comm world = Comm::world();
    const SlabTransform transform(nx, ny, world);
    const SlabShare& share = transform.share();
    AlignedVector<double> plane(static_cast<std::size_t>(share.reals));
    // A real field of two waves, one of them with negative kx.
    const double a = 0.7, b = -1.3, phase = 0.4;
    const std::ptrdiff_t kx_b = nx - 1, ky_b = ny / 2 - 1;
    auto* spectrum = reinterpret_cast<std::complex<double>*>(plane.data());
    for (std::ptrdiff_t j = 0; j < share.ky_count; ++j) {
        for (std::ptrdiff_t i = 0; i < nx; ++i) {
            std::complex<double> value = 0.0;
            const std::ptrdiff_t ky = share.ky_start + j;
            // The half spectrum's ky = 0 row carries both signs of kx itself.
            if (ky == 0 && (i == 1 || i == nx - 1)) value += 0.5 * a;
            if (ky == ky_b && i == kx_b)
                value += (ky_b == 0 ? 1.0 : 0.5) * b * std::polar(1.0, phase);
            spectrum[j * nx + i] = value;
        }
    }
    transform.execute(plane.data());
    double worst = 0.0, rows = 0.0;
    for (std::ptrdiff_t i = 0; i < share.x_count; ++i, ++rows) {
        for (std::ptrdiff_t j = 0; j < ny; ++j) {
            const double x = 2.0 * std::numbers::pi * static_cast<double>(share.x_start + i) /
                             static_cast<double>(nx);
            const double y =
                2.0 * std::numbers::pi * static_cast<double>(j) / static_cast<double>(ny);
            double expected = a * std::cos(x);
            if (ky_b > 0) expected += b * std::cos(-x + static_cast<double>(ky_b) * y + phase);
            if (ky_b == 0) continue; // 4 x 2: only the size of the answer is checked below
            worst = test::worse(
                worst,
                std::abs(plane[static_cast<std::size_t>(i * share.padded_ny + j)] - expected));
        }
    }
    CHECK(world.max(worst) < 1e-13);
    CHECK(world.sum(rows) == static_cast<double>(nx)); // every row has exactly one owner
    CHECK(world.sum(static_cast<double>(share.ky_count)) == static_cast<double>(ny / 2 + 1));
}
