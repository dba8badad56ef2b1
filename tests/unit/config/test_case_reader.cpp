#include "unit/config/jobs.hpp"

using namespace shearwake;
using namespace shearwake::test;

TEST_CASE("what a job leaves out has stated defaults", "[config][case]") {
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

TEST_CASE("what a job gives is read in SI", "[config][case]") {
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

TEST_CASE("a time that stands on a frame is that frame exactly", "[config][case]") {
    const Case c = only_case(plain_and("[measure]\nat_ms = 3.35\n"));
    CHECK(c.measure.at_s == c.time.frame_s(66));
}

TEST_CASE("a grid is as long as it must be and good to transform", "[config][case]") {
    CHECK(only_case(plain_with("[96.0, 64.0]", "[96.1, 63.0]")).domain.nx == 140); // 129 -> 140
    CHECK(only_case(plain_with("[96.0, 64.0]", "[96.1, 63.0]")).domain.ny == 84);
}

TEST_CASE("a mistake in domain or time stands in its place", "[config][case]") {
    const auto [old, by, finding] = GENERATE(table<std::string, std::string, std::string>({
        {"[96.0, 64.0]", "[96.0, -64.0]",
         "job.toml:22:20: error: domain.extent_mm must be above 0, and is -64"},
        {"extent_mm", "extent_cm",
         "job.toml:22:1: error: domain.extent_cm is unknown; extent is given in mm here: "
         "extent_mm"},
        {"[96.0, 64.0]", "[1e6, 64.0]",
         "job.toml:23:14: error: domain.spacing_mm makes 1333334 points along 1e+06 mm; at most "
         "32768 are possible"},
        {"= 0.75", "= 0.75\nsponge_mm = 34",
         "job.toml:24:13: error: domain.sponge_mm must leave something between the margins: below "
         "33.75 mm, half of the shorter side; it is 34"},
        {"= 4.0", "= 4.01",
         "job.toml:25:15: error: time.duration_ms must be a whole number of output intervals, and "
         "4.01 ms are 80.2 times 50 us"},
        {"= 4.0", "= 0.01",
         "job.toml:25:15: error: time.duration_ms must be a whole number of output intervals, and "
         "0.01 ms are 0.2 times 50 us"},
        {"= 50.0", "= 1e-6",
         "job.toml:26:22: error: time.output_interval_us makes 4000000000 frames; at most 1000000 "
         "are possible"},
        {"duration_ms = 4.0\n", "", "job.toml:24:1: error: time.duration_ms is missing"},
    }));
    CHECK(findings_of(plain_with(old, by)) == Texts{finding});
}

TEST_CASE("a mistake in solver, measure or record stands in its place", "[config][case]") {
    const auto [more, finding] = GENERATE(table<std::string, std::string>({
        {"[solver]\nengine = \"fem\"\n",
         "job.toml:28:10: error: solver.engine must be one of \"layered\", \"spectral\" or "
         "\"pstd\", and is \"fem\""},
        {"[solver]\nengine = \"spectral\"\n[solver.spectral]\ndegree = 8.5",
         "job.toml:30:10: error: solver.spectral.degree must be a whole number"},
        {"[solver.layered]\nwindow_factor = 1",
         "job.toml:28:17: error: solver.layered.window_factor must be between 1.25 and 16, and is "
         "1"},
        {"[solver.layered]\nwrap_suppression = 1e9",
         "job.toml:28:20: error: solver.layered.wrap_suppression must be between 10 and 100000000, "
         "and is 1000000000"},
        {"[solver.layered]\ninterpolation_tolerance = 1",
         "job.toml:28:27: error: solver.layered.interpolation_tolerance must be between 1e-12 and "
         "0.001, and is 1"},
        {"[solver.layered]\ntime_step_us = 51",
         "job.toml:28:16: error: solver.layered.time_step_us must not exceed "
         "time.output_interval_us = 50, and is 51"},
        {"[measure]\nat_ms = 5",
         "job.toml:28:9: error: measure.at_ms must be a frame of the run: a multiple of "
         "time.output_interval_us = 50 from one up to time.duration_ms = 4; 5 is none"},
        {"[measure]\nat_ms = 3.99",
         "job.toml:28:9: error: measure.at_ms must be a frame of the run: a multiple of "
         "time.output_interval_us = 50 from one up to time.duration_ms = 4; 3.99 is none"},
        {"[measure]\nat_ms = 3\nsettled_after_ms = 3",
         "job.toml:29:20: error: measure.settled_after_ms must be before measure.at_ms = 3, and is "
         "3"},
        {"[measure]\nfocal_radius_mm = 3\nfocal_radius_fwhm = 1",
         "job.toml:28:19: error: measure.focal_radius_mm and focal_radius_fwhm are both given; one "
         "of them says it all"},
        {"[measure]\ndepths_mm = [1, 0.5]",
         "job.toml:28:13: error: measure.depths_mm must ascend, and 0.5 follows on 1"},
        {"[measure]\ndepths_mm = [0, 20]",
         "job.toml:28:13: error: measure.depths_mm must lie above the rigid base, 20 mm deep, and "
         "holds 20"},
        {"[measure]\ndepths_mm = [0, -1]",
         "job.toml:28:17: error: measure.depths_mm must be at least 0, and is -1"},
        {"[measure]\ndepths_mm = []",
         "job.toml:28:13: error: measure.depths_mm must hold a depth; 0 is the surface"},
        {"[measure]\ndepths_mm = 1",
         "job.toml:28:13: error: measure.depths_mm must be a list of numbers, and is a number"},
        {"[record]\ntraces_mm = [[0, 0], [49, 0]]",
         "job.toml:28:13: error: record.traces_mm must lie in the domain, within 48 and 33.75 mm "
         "of its middle; [49, 0] does not"},
        {"[measure]\nbands_Hz = [[100, 500], [500, 100]]",
         "job.toml:28:12: error: measure.bands_Hz must hold bands [low, high] that rise from 0 on, "
         "and holds [500, 100]"},
        {"[record]\ntraces_mm = [0, 0]",
         "job.toml:28:14: error: record.traces_mm must be a pair [x, y], and is a number"},
        {"[record]\nsnapshots_ms = [2.01]",
         "job.toml:28:16: error: record.snapshots_ms must be a frame of the run: a multiple of "
         "time.output_interval_us = 50 from one up to time.duration_ms = 4; 2.01 is none"},
        {"[record]\nvolumes_ms = [2.01]",
         "job.toml:28:14: error: record.volumes_ms must be a frame of the run: a multiple of "
         "time.output_interval_us = 50 from one up to time.duration_ms = 4; 2.01 is none"},
        {"[record]\nvolumes_ms = [2]\nvolume_fields = [\"v\"]",
         "job.toml:29:17: error: record.volume_fields must hold some of \"u\", \"strain\" or "
         "\"stress\", and holds \"v\""},
        {"[record]\nvolumes_ms = [2]\nvolume_fields = []",
         "job.toml:29:17: error: record.volume_fields must hold some of \"u\", \"strain\" or "
         "\"stress\""},
        {"[record]\nvolume_fields = [\"u\"]",
         "job.toml:28:17: error: record.volume_fields says what is kept at record.volumes_ms, "
         "which is not given: give the times, or leave it out"},
        {"[record]\nframes = 1",
         "job.toml:28:10: error: record.frames must be true or false, and is a number"},
    }));
    CHECK(findings_of(plain_and(more)) == Texts{finding});
}

TEST_CASE("a section that is no table is told so", "[config][case]") {
    CHECK(findings_of("record = 3\n" + std::string(plain_job)) ==
          Texts{"job.toml:1:10: error: record must be a table, and is a number"});
}

TEST_CASE("depths go as deep as they like in a half-space", "[config][case]") {
    std::string job = plain_with("\"rigid\"", "\"half-space\"");
    job = replaced(job, "thickness_mm = 20.0\n", "");
    CHECK(findings_of(job + "[measure]\ndepths_mm = [0, 500]\n").empty());
}

TEST_CASE("the stepping engine's options are read, and what it cannot compute is refused",
          "[job]") {
    const std::string chosen = "[solver]\nengine = \"spectral\"\n[solver.spectral]\n"
                               "time_step_us = 12.5\ndegree = 6\nlongest_element_mm = 2.0\n"
                               "absorbing_depth_mm = 40.0\n";
    const auto options = std::get<SpectralOptions>(only_case(plain_and(chosen)).solver);
    CHECK(options == SpectralOptions{12.5e-6, 6, 2e-3, 40e-3});
    std::string lossy =
        replaced(plain_and(chosen), "viscosity_Pa_s = 1.0",
                 "loss = { law = \"fractional\", tau_us = 260.0, exponent = 0.27 }");
    const Texts found = findings_of(lossy);
    REQUIRE(found.size() == 1);
    CHECK(found[0].find("error: solver.engine: \"spectral\" takes layers") != std::string::npos);
}

TEST_CASE("the stepping engine takes a time step or an accuracy to choose it from",
          "[config][case]") {
    const std::string spectral = "[solver]\nengine = \"spectral\"\n";
    const auto options_of = [&](const std::string& rest) {
        return std::get<SpectralOptions>(only_case(plain_and(spectral + rest)).solver);
    };
    CHECK(options_of("") == SpectralOptions{.time_step_s = {}, .accuracy = 1e-3});
    CHECK(options_of("spectral.accuracy = 1e-2") == SpectralOptions{.accuracy = 1e-2});
    CHECK(options_of("spectral.time_step_us = 12.5") == SpectralOptions{.time_step_s = 12.5e-6});
    CHECK(options_of("spectral = { time_step_us = \"auto\", accuracy = 1e-2 }") ==
          SpectralOptions{.accuracy = 1e-2});
}

TEST_CASE("a silly accuracy of the stepping engine, or one beside a time step, is refused",
          "[config][case]") {
    const auto [given, finding] = GENERATE(table<std::string, std::string>({
        {"accuracy = 0", "accuracy must be between 0.0001 and 0.1, and is 0"},
        {"accuracy = 2", "accuracy must be between 0.0001 and 0.1, and is 2"},
        {"accuracy = \"x\"", "accuracy must be a number, and is a string"},
        {"time_step_us = \"fast\"", "time_step_us must be a number, and is a string"},
        {"time_step_us = 25, accuracy = 1e-2",
         "accuracy chooses the time step, and solver.spectral.time_step_us = 25 gives it; leave "
         "one of them out, or set the latter to \"auto\""},
    }));
    const Texts found = findings_of(plain_and("[solver]\nspectral = { " + given + " }\n"));
    REQUIRE(found.size() == 1);
    CHECK_THAT(found[0], Catch::Contains("error: solver.spectral." + finding));
}

TEST_CASE("volumes are kept in order, each once, whatever the order of the job", "[config][case]") {
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

TEST_CASE("the options of engine pstd are read, and what it cannot compute is refused", "[job]") {
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
    CHECK(all.time_step_s == 2.5e-6);
    CHECK(all.displacement_m == Approx(3.6e-6).epsilon(1e-14));
    PstdOptions expected{2.5e-6,
                         5.0,
                         PstdTop::fluid,
                         900.0,
                         40.0,
                         PstdLoad::displacement,
                         all.displacement_m,
                         15e-3,
                         12,
                         2.0,
                         true,
                         Precision::single_precision};
    CHECK(all == expected);

    const auto [more, finding] = GENERATE(table<std::string, std::string>({
        {"top = \"air\"", "solver.pstd.top must be one of \"void\", \"continued\" or \"fluid\""},
        {"fluid_c_p_m_s = 40", "solver.pstd.fluid_c_p_m_s is of solver.pstd.top = \"fluid\""},
        {"load = \"displacement\"", "solver.pstd.load needs solver.pstd.displacement_um"},
        {"displacement_um = 1", "solver.pstd.displacement_um is of solver.pstd.load"},
        {"absorbing_points = 10.5", "solver.pstd.absorbing_points must be a whole number"},
        {"c_p_over_c_s = 1", "solver.pstd.c_p_over_c_s must be between 2 and 1000"},
        {"[record]\nvolumes_ms = [4]\nvolume_fields = [\"strain\"]", "keeps; solver.engine ="},
    }));
    const Texts found = findings_of(plain_and(chosen + more));
    REQUIRE(found.size() == 1);
    CHECK(found[0].find(finding) != std::string::npos);

    const Texts lossy =
        findings_of(replaced(plain_and(chosen), "viscosity_Pa_s = 1.0",
                             "loss = { law = \"fractional\", tau_us = 260.0, exponent = 0.27 }"));
    REQUIRE(lossy.size() == 1);
    CHECK(lossy[0].find("error: solver.engine: \"pstd\" takes layers") != std::string::npos);
    const Texts array = findings_of(replaced(
        plain_and(chosen), "footprint = { shape = \"gaussian\", fwhm_mm = 3.0 }",
        "footprint = { shape = \"array\", preset = \"array-16x16\", distance_mm = 200.0 }"));
    CHECK(any_contains(array, "the engine \"pstd\" takes Gaussian foci"));
}
