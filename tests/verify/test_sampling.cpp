// SPDX-License-Identifier: BSD-3-Clause
// Effects of sampling on the results: carrier, grid and time.
#include "config/job.hpp"
#include "measures/spectrum.hpp"
#include "storage/files.hpp"
#include "support/cases.hpp"
#include "support/places.hpp"

#include <catch2/catch.hpp>

namespace test_sampling {

using namespace shearwake;

static std::vector<double> trace_at_centre(const test::FrameStore& frames, const Case& c) {
    std::vector<double> u;
    for (std::ptrdiff_t n = 0; n < c.time.frames; ++n)
        u.push_back(frames.at(
            n)[static_cast<std::size_t>(c.domain.nx / 2 * c.domain.ny + c.domain.ny / 2)]);
    return u;
}

static double difference(const std::vector<double>& a, const std::vector<double>& b) {
    double above = 0.0, below = 0.0;
    for (std::size_t i = 0; i < a.size(); ++i) {
        above += (a[i] - b[i]) * (a[i] - b[i]);
        below += b[i] * b[i];
    }
    return std::sqrt(above / below);
}

TEST_CASE("averaged and resolved carrier agree below 2 kHz", "[verify]") {
    // Frames resolve 40 kHz, so that there is no aliasing; spectra of the complete run.
    Case averaged = test::moving_focus(test::half_space(test::tissue(1500.0)), ConstantSpeed{7.0});
    auto& travel = test::travel_of(averaged);
    std::get<Line>(travel.path.shape).from_m = {-21e-3, 0.0};
    averaged.domain = {96, 64, 0.75e-3, 0.0};
    averaged.time = {1000, 5e-6};
    averaged.scene.load.modulation.envelope = {{SineGain{.frequency_Hz = 400.0}}};
    Case resolved = averaged;
    resolved.scene.load.carrier = ResolvedCarrier{40e3};

    const auto u_averaged = trace_at_centre(test::frames_of(averaged), averaged);
    const auto u_resolved = trace_at_centre(test::frames_of(resolved), resolved);
    std::vector<double> frequencies;
    for (double f = 0.0; f <= 2000.0; f += 20.0)
        frequencies.push_back(f);
    const auto a = measures::amplitude_spectrum(u_averaged, 5e-6, frequencies);
    const auto b = measures::amplitude_spectrum(u_resolved, 5e-6, frequencies);
    CHECK(difference(b, a) < 0.01); // required
    // The carrier is present: the difference is a line at 40 kHz.
    std::vector<double> rest;
    for (std::size_t i = 0; i < u_resolved.size(); ++i)
        rest.push_back(u_resolved[i] - u_averaged[i]);
    const std::vector<double> around = {36e3, 40e3, 44e3};
    const auto line = measures::amplitude_spectrum(rest, 5e-6, around);
    CHECK(line[1] > 10.0 * line[0]);
    CHECK(line[1] > 10.0 * line[2]);
}

TEST_CASE("quickstart job is converged in spacing and time", "[long][verify]") {
    const std::string text = storage::read_file(test::jobs_folder / "quickstart.toml");
    const std::vector<config::Override> coarse = {
        {"sweep", "{\"load.modulation.am_frequency_Hz\" = [200]}"}};
    std::vector<config::Override> fine = coarse;
    fine.push_back({"domain.spacing_mm", "0.375"});
    fine.push_back({"time.output_interval_us", "25"});
    const config::Job before = config::read_job(text, "quickstart.toml", coarse);
    const config::Job after = config::read_job(text, "quickstart.toml", fine);
    REQUIRE(before.plan.cases.size() == 2); // and the reference
    const Comm alone = Comm::world().split(Comm::world().rank());
    for (std::size_t i = 0; i < 2; ++i) {
        const Case &a = before.plan.cases[i].physics, &b = after.plan.cases[i].physics;
        REQUIRE(b.domain.nx == 2 * a.domain.nx);
        REQUIRE(b.time.frames == 2 * a.time.frames);
        const double eta_a =
            test::columns_of(a, *engines::make_engine(a.solver), alone).at("eta_period_1");
        const double eta_b =
            test::columns_of(b, *engines::make_engine(b.solver), alone).at("eta_period_1");
        CAPTURE(before.plan.cases[i].is_reference);
        CHECK(eta_b == Approx(eta_a).epsilon(0.005)); // required
    }
}

} // namespace test_sampling
