#include "support/cases.hpp"

#include <catch2/catch.hpp>
#include <cmath>

using namespace shearwake;

namespace {

/// A focus that rests, is pushed and let go, over soft tissue of c_p/c_s = 10, for 4 ms.
Case resting_focus(const SolverOptions& solver, double fwhm_m, double spacing_m) {
    Case c = test::moving_focus(test::half_space(test::tissue(50.0, 1.0)), ConstantSpeed{1.0});
    c.load.footprint = GaussianFootprint{fwhm_m};
    c.load.modulation.trajectory = {{Hold{{0.0, 0.0}}}};
    c.load.modulation.envelope = {{SineGain{.frequency_Hz = 250.0}}};
    const auto points = good_even_length(std::lround(60e-3 / spacing_m));
    c.domain = {points, points, spacing_m, 0.0};
    c.time = {16, 250e-6};
    c.measure.at_s = 4e-3;
    c.solver = solver;
    return c;
}

/// Relative L2 difference of all frames.
double apart(const test::FrameStore& a, const test::FrameStore& b, std::ptrdiff_t frames) {
    double difference = 0.0, sum = 0.0;
    for (std::ptrdiff_t n = 0; n < frames; ++n) {
        const auto &of_a = a.at(n), &of_b = b.at(n);
        for (std::size_t i = 0; i < of_a.size(); ++i) {
            difference += std::pow(of_a[i] - of_b[i], 2);
            sum += of_b[i] * of_b[i];
        }
    }
    return std::sqrt(difference / sum);
}

double error_of(const PstdOptions& options, double fwhm_m, double spacing_m) {
    const auto exact = test::frames_of(resting_focus(LayeredOptions{}, fwhm_m, spacing_m));
    const auto stepped = test::frames_of(resting_focus(options, fwhm_m, spacing_m));
    return apart(stepped, exact, 16);
}

} // namespace

TEST_CASE("engine pstd moves the skin as the exact engine does", "[pstd]") {
    // Measured with nothing above the skin, on these grids: 1.7 % and 0.7 %.
    const double coarse = error_of(PstdOptions{}, 6e-3, 1.5e-3);
    const double fine = error_of(PstdOptions{}, 9e-3, 1.5e-3);
    INFO("relative L2 difference of the surface field " << coarse << " and " << fine
                                                        << " at 4 and 6 points a width");
    CHECK(coarse < 0.025);
    CHECK(fine < 0.01);
    // Better than the first order that is told of it.
    CHECK(std::log(coarse / fine) / std::log(6.0 / 4.0) > 1.0);
}
