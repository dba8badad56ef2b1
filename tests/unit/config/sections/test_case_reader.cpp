// SPDX-License-Identifier: BSD-3-Clause
#include "unit/config/jobs.hpp"

namespace test_case_reader {

using namespace shearwake;
using namespace shearwake::test;

TEST_CASE("omitted keys have the documented defaults", "[config][case]") {
    const Case c = only_case(plain_job);
    CHECK(c.domain == Domain{128, 90, 0.00075, 0.0});
    CHECK(c.time == TimeAxis{80, 5e-5});
    CHECK(c.measure.at_s == c.time.duration_s());
    CHECK(c.measure.settled_after_s == Approx(0.0010).epsilon(1e-14)); // a quarter of it
    CHECK(c.measure.focal_radius_m == 0.003);                          // 1 FWHM
    CHECK(c.measure.depths_m == std::vector{0.0});
    CHECK(c.record == RecordOptions{{{0.0, 0.0}}, {c.measure.at_s}, false});
    CHECK(c.solver == SolverOptions(LayeredOptions{}));
}

TEST_CASE("given keys are converted to SI units", "[config][case]") {
    const Case c = only_case(plain_and(R"(
[solver]
engine = "layered"
[solver.layered]
time_step_us = 12.5
window_factor = 3
wrap_suppression = 1e4
interpolation_tolerance = 1e-6
[measure]
at_ms = 3
settled_after_ms = 0.5
focal_radius_mm = 2
depths_mm = [0, 1.5, 4]
[record]
traces_mm = [[0, 0], [-3, 1]]
snapshots_ms = [1, 2.05]
frames = true
)"));
    CHECK(c.solver == SolverOptions(LayeredOptions{1.25e-5, 3.0, 1e4, 1e-6}));
    CHECK(c.measure.at_s == Approx(0.003).epsilon(1e-14));
    CHECK(c.measure.settled_after_s == 0.0005);
    CHECK(c.measure.focal_radius_m == 0.002);
    CHECK(c.measure.depths_m == std::vector{0.0, 0.0015, 0.004});
    CHECK(c.record.traces_m == std::vector<Vec2>{{0.0, 0.0}, {-0.003, 0.001}});
    CHECK(c.record.snapshots_s.at(1) == c.time.frame_s(40));
    CHECK(c.record.frames);
}

TEST_CASE("a time that coincides with a frame is exactly the time of that frame",
          "[config][case]") {
    const Case c = only_case(plain_and("[measure]\nat_ms = 3.35\n"));
    CHECK(c.measure.at_s == c.time.frame_s(66));
}

TEST_CASE("a grid has at least the requested extent and a size with fast FFTs", "[config][case]") {
    CHECK(only_case(plain_with("[96.0, 64.0]", "[96.1, 63.0]")).domain.nx == 140); // 129 -> 140
    CHECK(only_case(plain_with("[96.0, 64.0]", "[96.1, 63.0]")).domain.ny == 84);
}

TEST_CASE("an error in domain or time is reported with its location", "[config][case]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"extent_mm", "extent_cm", "22:1 domain.extent_cm is unknown; the unit of extent is mm"},
        {"= 0.75", "= 0.002", "23:14 domain.spacing_mm results in 48000 points along 96 mm"},
        {"[96.0, 64.0]", "[1e6, 64.0]", "22:14 domain.extent_mm must be between 1e-09 and 10000"},
        {"= 0.75", "= 0.75\nsponge_mm = 34", "24:13 domain.sponge_mm must leave a measured"},
        {"= 4.0", "= 4.01", "25:15 time.duration_ms must be a whole number of output intervals"},
        {"= 50.0", "= 1e-6", "26:22 time.output_interval_us results in 4000000000 frames"},
    }));
    check_only(diagnostics_of(plain_with(old, by)), error_at(diagnostic));
}

TEST_CASE("an error in solver, measure or record is reported with its location", "[config][case]") {
    const auto [more, diagnostic] = GENERATE(table<std::string, std::string>({
        {"[solver.layered]\ntime_step_us = 51", "28:16 solver.layered.time_step_us must not exceed "
                                                "time.output_interval_us = 50, but is 51"},
        {"[measure]\nat_ms = 3.99", "28:9 measure.at_ms must be the time of a frame: a multiple"},
        {"[measure]\nat_ms = 3\nsettled_after_ms = 3",
         "29:20 measure.settled_after_ms must be before measure.at_ms = 3, but is 3"},
        {"[measure]\nfocal_radius_mm = 3\nfocal_radius_fwhm = 1",
         "28:19 measure.focal_radius_mm and focal_radius_fwhm are both given; remove one"},
        {"[measure]\ndepths_mm = [1, 0.5]", "28:13 measure.depths_mm must be in ascending order"},
        {"[measure]\ndepths_mm = [0, 20]", "28:13 measure.depths_mm must lie above the rigid"},
        {"[record]\ntraces_mm = [[0, 0], [49, 0]]", "28:13 record.traces_mm must lie inside"},
        {"[measure]\nbands_Hz = [[100, 500], [500, 100]]", "28:12 measure.bands_Hz must contain"},
        {"[record]\nsnapshots_ms = [2.01]", "28:16 record.snapshots_ms must be the time"},
        {"[record]\nvolumes_ms = [2.01]", "28:14 record.volumes_ms must be the time of a frame"},
        {"[record]\nvolumes_ms = [2]\nvolume_fields = [\"v\"]",
         "29:17 record.volume_fields must contain only \"u\", \"strain\" or \"stress\""},
        {"[record]\nvolumes_ms = [2]\nvolume_fields = []",
         "29:17 record.volume_fields must contain at least one of \"u\", \"strain\" or \"stress\""},
        {"[record]\nvolume_fields = [\"u\"]", "28:17 record.volume_fields selects what is stored"},
    }));
    check_only(diagnostics_of(plain_and(more)), error_at(diagnostic));
}

TEST_CASE("a section that is not a table is rejected", "[config][case]") {
    CHECK(diagnostics_of("record = 3\n" + std::string(plain_job)) ==
          Texts{error_at("1:10 record must be a table, but is a number")});
}

TEST_CASE("depths are not limited in a half-space", "[config][case]") {
    std::string job = plain_with("\"rigid\"", "\"half-space\"");
    job = replaced(job, "thickness_mm = 20.0\n", "");
    CHECK(diagnostics_of(job + "[measure]\ndepths_mm = [0, 500]\n").empty());
}

TEST_CASE("the options of the spectral engine are read", "[job]") {
    const auto [keys, options] = GENERATE(table<std::string, SpectralOptions>({
        {"", {.time_step_s = {}, .accuracy = 1e-3}},
        {"spectral.accuracy = 1e-2", {.accuracy = 1e-2}},
        {"spectral.time_step_us = 12.5", {.time_step_s = 12.5e-6}},
        {"spectral = { time_step_us = \"auto\", accuracy = 1e-2 }", {.accuracy = 1e-2}},
        {"[solver.spectral]\ntime_step_us = 12.5\ndegree = 6\nlongest_element_mm = 2.0\n"
         "absorbing_depth_mm = 40.0\n",
         {12.5e-6, 6, 2e-3, 40e-3}},
    }));
    const Case c = only_case(plain_and("[solver]\nengine = \"spectral\"\n" + keys));
    CHECK(std::get<SpectralOptions>(c.solver) == options);
}

TEST_CASE("engines in time reject media and loads that they do not compute", "[job]") {
    const auto [engine, old, by, said] =
        GENERATE(table<std::string, std::string, std::string, std::string>({
            {"spectral", "viscosity_Pa_s = 1.0",
             "loss = { law = \"fractional\", tau_us = 260.0, exponent = 0.27 }",
             "error: solver.engine: \"spectral\" supports only lossless or Kelvin-Voigt layers"},
            {"pstd", "viscosity_Pa_s = 1.0",
             "loss = { law = \"fractional\", tau_us = 260.0, exponent = 0.27 }",
             "error: solver.engine: \"pstd\" supports only lossless or Kelvin-Voigt layers"},
            {"pstd", "shape = \"gaussian\", fwhm_mm = 3.0",
             "shape = \"array\", preset = \"array-16x16\", distance_mm = 200.0",
             "the engine \"pstd\" supports only Gaussian foci"},
        }));
    Texts errors =
        diagnostics_of(replaced(plain_and("[solver]\nengine = \"" + engine + "\"\n"), old, by));
    // The engine pstd also warns about the capped c_p.
    std::erase_if(errors, [](const auto& text) { return text.find("error: ") == text.npos; });
    CHECK(any_contains(errors, said));
    if (old.starts_with("viscosity")) CHECK(errors.size() == 1);
}

TEST_CASE("an accuracy of the spectral engine is rejected together with a time step",
          "[config][case]") {
    check_only(
        diagnostics_of(plain_and("[solver]\nspectral = { time_step_us = 25, accuracy = 1e-2 }\n")),
        "error: solver.spectral.accuracy applies only with time_step_us");
}

TEST_CASE("volumes are stored in order and without duplicates, independent of the order in the job",
          "[config][case]") {
    const std::string spectral = "[solver]\nengine = \"spectral\"\n[record]\n";
    const Case c = only_case(plain_and(spectral + "volumes_ms = [3, 1, 3]"));
    CHECK(c.record.volumes_s == std::vector{c.time.frame_s(19), c.time.frame_s(59)});
    CHECK(c.record.volume_fields == std::vector{VolumeField::u});
    CHECK(case_id(c) == case_id(only_case(plain_and(
                            spectral + "volumes_ms = [1, 3]\nvolume_fields = [\"u\", \"u\"]"))));
    // A job without volumes is the case it was before there were any.
    const Case without = only_case(plain_and(spectral + "volumes_ms = []"));
    CHECK(case_id(without) == case_id(only_case(plain_and(spectral))));
    CHECK(canonical_text(without).find("volume") == std::string::npos);
}

TEST_CASE("the options of the engine pstd are read", "[job]") {
    const std::string chosen = "[solver]\nengine = \"pstd\"\n[solver.pstd]\n";
    CHECK(only_case(plain_and(chosen)).solver == SolverOptions(PstdOptions{}));
    const auto all = std::get<PstdOptions>(
        only_case(plain_and(chosen +
                            "time_step_us = 2.5\nc_p_over_c_s = 5\ntop = \"fluid\"\n"
                            "fluid_density_kg_m3 = 900\nfluid_c_p_m_s = 40\n"
                            "load = \"displacement\"\ndisplacement_um = 3.6\ndepth_mm = 15\n"
                            "absorbing_points = 12\nabsorbing_strength = 2\n"
                            "edges = \"absorbing\"\nprecision = \"single\"\n"))
            .solver);
    CHECK(all.displacement_m == Approx(3.6e-6).epsilon(1e-14));
    CHECK(all == PstdOptions{2.5e-6, 5.0, PstdTop::fluid, 900.0, 40.0, PstdLoad::displacement,
                             all.displacement_m, 15e-3, 12, 2.0, PstdEdges::absorbing,
                             Precision::single_precision});

    const auto [more, diagnostic] = GENERATE(table<std::string, std::string>({
        {"fluid_c_p_m_s = 40", "solver.pstd.fluid_c_p_m_s applies only with top = \"fluid\""},
        {"load = \"displacement\"", "solver.pstd.displacement_um is missing"},
        {"displacement_um = 1", "solver.pstd.displacement_um applies only with load ="},
        {"[record]\nvolumes_ms = [4]\nvolume_fields = [\"strain\"]", "stores; solver.engine ="},
    }));
    Texts found = diagnostics_of(plain_and(chosen + more));
    // The engine also warns about the capped c_p.
    std::erase_if(found, [](const auto& text) { return text.find("error: ") == text.npos; });
    REQUIRE(found.size() == 1);
    CHECK(found[0].find(diagnostic) != std::string::npos);
}

} // namespace test_case_reader
