// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/presets.hpp"
#include "unit/config/jobs.hpp"

namespace test_medium_reader {

using namespace shearwake;
using namespace shearwake::test;

static Layer layer_with(std::string_view loss) {
    return only_case(plain_with("viscosity_Pa_s = 1.0", loss)).scene.medium.layers.at(0);
}

TEST_CASE("each loss law is read in SI", "[config][medium]") {
    CHECK(layer_with("viscosity_Pa_s = 2").loss == ShearLoss(KelvinVoigt{2.0}));
    CHECK(layer_with("loss = { law = \"kelvin-voigt\", viscosity_Pa_s = 2.0 }").loss ==
          ShearLoss(KelvinVoigt{2.0}));
    CHECK(layer_with("loss = { law = \"fractional\", tau_us = 260.0, exponent = 0.27 }").loss ==
          ShearLoss(FractionalKelvinVoigt{2.6e-4, 0.27}));
    CHECK(layer_with("loss = { law = \"standard-linear\", tau_us = 5, strength = 3 }").loss ==
          ShearLoss(StandardLinearSolid{5e-6, 3.0}));
    CHECK(layer_with("loss = \"none\"").loss == ShearLoss(Lossless{}));
    CHECK(layer_with("").loss == ShearLoss(Lossless{}));
    CHECK(layer_with("viscosity_Pa_s = 0").loss == ShearLoss(Lossless{}));
}

TEST_CASE("an error in a layer is reported with its location", "[config][medium]") {
    const auto [old, by, diagnostic] = GENERATE(table<std::string, std::string, std::string>({
        {"thickness_mm", "thickness_cm", "8:1 layer[1].thickness_cm is unknown; the unit"},
        {"= 20.0", "= nan", "8:16 layer[1].thickness_mm must be between 1e-09 and 10000"},
        {"= 20.0", "= inf", "8:16 layer[1].thickness_mm must be between 1e-09 and 10000"},
        {"= 20.0", "= 1979-05-27", "8:16 layer[1].thickness_mm must be a number, but is a date"},
        {"\"rigid\"", "\"half-space\"", "8:16 layer[1].thickness_mm does not apply"},
        {"c_p_m_s = 1500.0", "c_p_m_s = 5.5", "10:11 layer[1].c_p_m_s must be above 5.7735"},
        {"viscosity_Pa_s = 1.0", "viscosity_Pa_s = 1.0\nloss = \"none\"",
         "13:8 layer[1].loss and viscosity_Pa_s are both given; remove one of them from the job"},
        {"viscosity_Pa_s = 1.0", "loss = \"nne\"", "12:8 layer[1].loss must be \"none\""},
        {"viscosity_Pa_s = 1.0", "loss = { law = \"fractional\", tau_us = 1, exponent = 1.0 }",
         "12:53 layer[1].loss.exponent must be between 0 and 1, both excluded, but is 1"},
        {"viscosity_Pa_s = 1.0", "loss = { law = \"standard-linear\", tau_us = 1, strenth = 1 }",
         "12:47 layer[1].loss.strenth is unknown; did you mean strength?"},
        {"viscosity_Pa_s", "preset = \"three-layer-skin\"\nviscosity_Pa_s",
         "12:10 layer[1].preset must be one of \"palm\", \"thesis-tissue\", \"ecoflex\""},
        {"base = \"rigid\"", "base = \"rigid\"\npreset = \"ecoflex\"",
         "6:10 preset defines all layers, but medium.layer is also given; use the preset"},
    }));
    check_only(diagnostics_of(plain_with(old, by)), error_at(diagnostic, "medium."));
}

TEST_CASE("every preset gives a case without diagnostics", "[config][medium]") {
    const std::string name = GENERATE(from_range(config::preset_names()));
    const std::string job = with_medium("[medium]\npreset = \"" + name + "\"\n");
    const Medium medium = only_case(job).scene.medium;
    CHECK_FALSE(medium.layers.empty());
    for (const Layer& layer : medium.layers)
        CHECK(layer.c_p_m_s / layer.c_s_m_s > std::sqrt(51.0)); // a Poisson's ratio above 0.49
}

TEST_CASE("the presets have the values of their sources", "[config][medium]") {
    const auto layers = [](const std::string& name) {
        return only_case(with_medium("[medium]\npreset = \"" + name + "\"\n")).scene.medium.layers;
    };
    CHECK(static_shear_modulus(layers("ecoflex")[0]) == Approx(27.8e3).epsilon(2e-3));
    CHECK(layers("ecoflex")[0].loss == ShearLoss(FractionalKelvinVoigt{260e-6, 0.27}));
    CHECK(static_shear_modulus(layers("forearm")[0]) == Approx(7860.0).epsilon(1e-12));
    CHECK(layers("forearm")[0].loss == ShearLoss(KelvinVoigt{5.03}));
    CHECK(layers("thesis-tissue")[0].c_s_m_s == 5.0);
    const auto skin = layers("three-layer-skin");
    REQUIRE(skin.size() == 3);
    CHECK(static_shear_modulus(skin[0]) == Approx(1.33e6).epsilon(1e-12));
    CHECK(static_shear_modulus(skin[1]) == Approx(13.3e3).epsilon(1e-12));
    CHECK(static_shear_modulus(skin[2]) == Approx(5e3).epsilon(1e-12));
    CHECK(skin[1].thickness_m == 0.002);
    CHECK(skin[2].thickness_m == 0.0);
}

TEST_CASE("a layer's preset fills in only what is not given", "[config][medium]") {
    const auto layer = [](const std::string& more) {
        return only_case(
                   with_medium(
                       "[medium]\nbase = \"rigid\"\n[[medium.layer]]\npreset = \"ecoflex\"\n" +
                       more))
            .scene.medium.layers.at(0);
    };
    CHECK(layer("").c_s_m_s == 5.10);
    CHECK(layer("c_s_m_s = 6.0\n").c_s_m_s == 6.0);
    CHECK(layer("viscosity_Pa_s = 2.0\n").loss == ShearLoss(KelvinVoigt{2.0}));
    CHECK(layer("name = \"gel\"\n").name == "gel");
}

TEST_CASE("the thickness of a preset is ignored in a half-space", "[config][medium]") {
    const Medium medium =
        only_case(with_medium("[medium]\nbase = \"half-space\"\n[[medium.layer]]\npreset = "
                              "\"ecoflex\"\n[[medium.layer]]\npreset = \"forearm\"\n"))
            .scene.medium;
    CHECK(medium.base == Base::half_space);
    CHECK(medium.layers.at(0).thickness_m == 0.02);
    CHECK(medium.layers.at(1).thickness_m == 0.0);
}

TEST_CASE("an unknown preset or a medium without layers is rejected", "[config][medium]") {
    const auto [medium, said] = GENERATE(table<std::string, std::string>({
        {"base = \"rigid\"\npreset = \"forarm\"",
         "6:10 preset must be one of \"palm\", \"thesis-tissue\", \"ecoflex\", \"forearm\", "
         "\"fingertip\" or \"three-layer-skin\", but is \"forarm\"; did you mean \"forearm\"?"},
        {"base = \"rigid\"\nlayer = []", "6:9 layer must contain at least one layer"},
    }));
    check_only(diagnostics_of(with_medium("[medium]\n" + medium + "\n")),
               error_at(said, "medium."));
    // Keys that a preset supplies are not reported as missing, and other errors are found.
    const Texts found = diagnostics_of(
        replaced(with_medium("[medium]\npreset = \"soup\"\n"), "spacing_mm = ", "spacing_mm = -"));
    REQUIRE(found.size() == 2);
    CHECK_THAT(found[0], Catch::Contains("medium.preset must be one of"));
    CHECK_THAT(found[1], Catch::Contains("domain.spacing_mm must be between 1e-09 and 10000"));
}

} // namespace test_medium_reader
