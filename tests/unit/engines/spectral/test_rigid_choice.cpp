// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/bodies/rigid_choice.hpp"
#include "engines/spectral/spectral_plan.hpp"

#include <catch2/catch.hpp>
#include <algorithm>
#include <cmath>

namespace test_rigid_choice {

using namespace shearwake;

/// A bone of 6 mm diameter along y, 2e5 times stiffer than the tissue around it.
static Case bone_case() {
    Case c;
    c.scene.medium.layers = {{.name = "tissue",
                              .thickness_m = 0.02,
                              .density_kg_m3 = 1e3,
                              .c_p_m_s = 1500.0,
                              .c_s_m_s = 5.0}};
    c.scene.medium.bodies = {{.name = "bone",
                              .shape = Cylinder{.radius_m = 3e-3, .azimuth_deg = 90.0},
                              .centre_m = {0.0, 0.0, 8e-3},
                              .density_kg_m3 = 1900.0,
                              .c_p_m_s = 3517.0,
                              .c_s_m_s = 1619.0}};
    c.domain = {.nx = 64, .ny = 48, .spacing_m = 1e-3};
    c.solver = SpectralOptions{.time_step_s = 50e-6};
    return c;
}

static bool is_rigid(const Case& c) {
    return spectral::rigid_plan(c).c.scene.medium.bodies[0].rigid;
}

TEST_CASE("a body far stiffer than its surroundings is rigid", "[rigid_choice]") {
    Case c = bone_case();
    Body& bone = c.scene.medium.bodies[0];
    CHECK(spectral::stiffness_contrast(bone, c.scene.medium) ==
          Approx(1.9 * std::pow(1619.0 / 5.0, 2)));
    CHECK(is_rigid(c));
    SECTION("also where it does not cross the domain") {
        bone.shape = Ellipsoid{{4e-3, 4e-3, 4e-3}};
        CHECK(is_rigid(c));
    }
    SECTION("unless it is small and does not cross the domain") { // 1 mm
        bone.shape = Ellipsoid{{2.9e-3, 4e-3, 4e-3}};
        CHECK_FALSE(is_rigid(c));
        CHECK_THAT(spectral::rigid_plan(c).reasons[0],
                   Catch::Contains("it is 5.8 grid spacings wide"));
        bone.shape = Cylinder{.radius_m = 2.9e-3};
        CHECK(is_rigid(c));
    }
    SECTION("unless the limit is higher") {
        std::get<SpectralOptions>(c.solver).rigid_above = 2e5;
        CHECK_FALSE(is_rigid(c));
        std::get<SpectralOptions>(c.solver).rigid_above = 1.9e5;
        CHECK(is_rigid(c));
    }
    SECTION("unless a layer around it is almost as stiff") {
        Layer gel = c.scene.medium.layers[0];
        gel.c_s_m_s = 120.0;
        c.scene.medium.layers[0].thickness_m = 6e-3;
        c.scene.medium.layers.push_back(gel);
        CHECK_FALSE(is_rigid(c)); // it extends from 5 to 11 mm
        c.scene.medium.layers[0].thickness_m = 12e-3;
        CHECK(is_rigid(c));
    }
    SECTION("unless it is lighter than its surroundings") {
        bone.density_kg_m3 = 900.0;
        CHECK_FALSE(is_rigid(c));
    }
    SECTION("unless rigid bodies do not support its shape or place") {
        SECTION("a lump with too many markers") {
            bone.shape = Ellipsoid{{30e-3, 22e-3, 7e-3}};
        }
        SECTION("a lump as long as the domain") {
            bone.shape = Cylinder{.radius_m = 3e-3, .length_m = 64e-3};
        }
        SECTION("a smooth edge") {
            bone.edge_m = 2e-3;
        }
        SECTION("a body that reaches the surface") {
            bone.centre_m.z = 2e-3;
        }
        SECTION("a body that overlaps another one") {
            Body fat = bone;
            fat.c_s_m_s = 3.0;
            fat.density_kg_m3 = 900.0;
            c.scene.medium.bodies.push_back(fat);
        }
        CHECK_FALSE(is_rigid(c));
        CHECK(spectral::rigid_limits(c).empty()); // it is elastic then
    }
}

TEST_CASE("rigid bodies that are not supported are rejected with the reason", "[rigid_choice]") {
    Case c = bone_case();
    Body& bone = c.scene.medium.bodies[0];
    bone.shape = Ellipsoid{{4e-3, 4e-3, 4e-3}};
    bone.rigid = true;
    CHECK(spectral::rigid_limits(c).empty());
    std::string reason;
    SECTION("at the surface") {
        bone.centre_m.z = 4e-3;
        reason = "must not touch the surface, but it begins at 0 mm";
    }
    SECTION("narrower than two spacings") {
        bone.shape = Ellipsoid{{4e-3, 0.9e-3, 4e-3}};
        reason = "must be at least 2 grid spacings wide, but it is 1.8 mm wide";
    }
    SECTION("as long as the domain") {
        bone.shape = Box{{64e-3, 4e-3, 4e-3}};
        CHECK(spectral::rigid_limits(c).empty()); // from edge to edge
        bone.shape = Cylinder{.radius_m = 3e-3, .length_m = 64e-3};
        reason = "as long as the domain must be parallel to x or y";
    }
    SECTION("with a smooth edge") {
        bone.edge_m = 1e-3;
        reason = "has a sharp surface; remove edge_mm";
    }
    SECTION("that overlap") {
        reason = "must not overlap another body, but it overlaps medium.body[1]";
        Body other = bone;
        other.rigid = GENERATE(true, false);
        SECTION("inside the domain") {
            other.centre_m.x = 7.9e-3;
        }
        SECTION("across the periodic edges") { // 64 x 48 mm
            bone.centre_m.x = 29e-3;
            bone.centre_m.y = -22e-3;
            other.centre_m.x = -28e-3;
            other.centre_m.y = 23e-3;
        }
        if (!other.rigid) reason = "must not overlap another body, but it overlaps medium.body[2]";
        c.scene.medium.bodies.push_back(other);
    }
    SECTION("unless they are next to each other") {
        Body other = bone;
        other.centre_m.x = 8e-3;
        c.scene.medium.bodies.push_back(other);
        CHECK(spectral::rigid_limits(c).empty());
        return;
    }
    const auto limits = spectral::rigid_limits(c);
    REQUIRE(limits.size() == 1);
    CAPTURE(limits[0].message);
    CHECK(limits[0].severity == Severity::error);
    CHECK(limits[0].message.find(reason) != std::string::npos);
}

TEST_CASE("notes state how each body is treated", "[rigid_choice]") {
    Case c = bone_case();
    Body& bone = c.scene.medium.bodies[0];
    const auto note = [&] { return spectral::body_notes(spectral::rigid_plan(c)).at(0); };
    const std::string elastic =
        "medium.body[1] is elastic, 1.99e+05 times as stiff as its surroundings. It is not "
        "treated as rigid: ";
    SECTION("elastic") {
        bone.density_kg_m3 = 1000.0;
        bone.c_s_m_s = 10.0;
        CHECK(note() == "medium.body[1] is elastic, 4 times as stiff as its surroundings");
        bone.c_s_m_s.reset();
        CHECK(note() == "medium.body[1] is elastic");
    }
    SECTION("at the surface") {
        bone.centre_m.z = 2e-3;
        CHECK(note() ==
              elastic + "a rigid body must not touch the surface, but it begins at -1 mm");
    }
    SECTION("with many markers") {
        bone.shape = Ellipsoid{{30e-3, 22e-3, 7e-3}};
        CHECK(note().find(elastic + "it would need more than 2000 markers") == 0);
    }
    SECTION("light") {
        bone.density_kg_m3 = 900.0;
        CHECK(note().find(". It is not treated as rigid: it is lighter than its surroundings") !=
              std::string::npos);
    }
    SECTION("rigid") {
        CHECK(note().find("medium.body[1] is rigid because it is 1.99e+05 times stiffer") == 0);
        bone.shape = Ellipsoid{{6e-3, 5e-3, 3e-3}};
        CHECK_THAT(spectral::rigid_plan(c).why,
                   Catch::Contains("because it does not cross the domain"));
    }
}

TEST_CASE("bodies along different axes and complete layers are rigid together", "[rigid_choice]") {
    Case c = bone_case();
    Body across = c.scene.medium.bodies[0];
    across.shape = Cylinder{.radius_m = 2e-3, .azimuth_deg = 0.0};
    across.centre_m.z = 14e-3;
    c.scene.medium.bodies.push_back(across);
    Body layer = across;
    layer.shape = Box{{1.0, 1.0, 2e-3}};
    layer.centre_m.z = 18e-3;
    c.scene.medium.bodies.push_back(layer);
    SECTION("with a common matrix") {
        const spectral::RigidPlan chosen = spectral::rigid_plan(c);
        CHECK(spectral::rigid_bodies(chosen.marked).size() == 3);
        CHECK(chosen.treatment == spectral::RigidTreatment::lumps);
        CHECK(chosen.bodies.size() == 2);
        CHECK_THAT(chosen.why, Catch::Contains("not all of them cross the domain along the same"));
        const Medium& solved = chosen.c.scene.medium; // ends at the complete layer
        CHECK(solved.base == Base::rigid);
        CHECK(depths(solved, solved.layers.size() - 1).bottom_m == Approx(17e-3));
    }
    SECTION("with one matrix per wavenumber if they are parallel") {
        std::get<Cylinder>(c.scene.medium.bodies[1].shape).azimuth_deg = -90.0;
        const spectral::RigidPlan chosen = spectral::rigid_plan(c);
        CHECK(spectral::rigid_bodies(chosen.marked).size() == 3);
        CHECK(chosen.treatment == spectral::RigidTreatment::endless);
        CHECK(chosen.bodies.size() == 2);
        CHECK_THAT(chosen.why, Catch::Contains("along y"));
    }
    SECTION("unless their matrix would be too large") {
        c.domain = {.nx = 160, .ny = 120, .spacing_m = 0.5e-3};
        const spectral::RigidPlan chosen = spectral::rigid_plan(c);
        const std::vector<Body>& bodies = chosen.marked.scene.medium.bodies;
        CHECK(bodies[0].rigid);
        CHECK_FALSE(bodies[1].rigid);
        CHECK(bodies[2].rigid);
        auto notes = spectral::body_notes(chosen);
        for (const std::string& note : engines::notes_of(spectral::cap_choices(chosen.marked)))
            notes.push_back(note);
        const auto mentions = [&](const std::string& text) {
            return std::any_of(notes.begin(), notes.end(), [&](const std::string& note) {
                return note.find(text) != std::string::npos;
            });
        };
        CHECK(mentions("medium.body[1] is rigid because it is 1.99e+05 times stiffer"));
        CHECK(mentions("medium.body[2]: shear stiffness 1.99e+05 times"));
    }
}

TEST_CASE("receptors of stress that may lie inside a rigid body are reported", "[rigid_choice]") {
    Case c = bone_case(); // spacing 1 mm, receptors down to 2 mm
    Body& bone = c.scene.medium.bodies[0];
    bone.rigid = true;
    bone.shape = Ellipsoid{{5e-3, 5e-3, 2e-3}};
    c.afferents = AfferentOptions{};
    c.afferents->input = StressInput{};
    bone.centre_m.z = 6.6e-3; // its top is 2.6 spacings below the deepest receptors
    CHECK(spectral::receptors_near_bodies(c).empty());
    bone.centre_m.z = 6.4e-3;
    const auto warning = [&] {
        const std::vector<Remark> warnings = spectral::receptors_near_bodies(c);
        REQUIRE(warnings.size() == 1);
        CHECK(warnings[0].severity == Severity::warning);
        return warnings[0].message;
    };
    const auto curved = Catch::Contains("reaches 26 % of the largest stress"),
               with_edges = Catch::Contains("reaches 47 % of the largest stress");
    CHECK_THAT(warning(), curved);
    SECTION("with the error around its edges") {
        bone.shape = Cylinder{.radius_m = 2e-3, .length_m = 5e-3};
        CHECK_THAT(warning(), with_edges);
        bone.shape = Box{{5e-3, 5e-3, 4e-3}};
        CHECK_THAT(warning(), with_edges);
    }
    SECTION("as of a body across the domain, whose section may be round") {
        bone.shape = Cylinder{.radius_m = 2e-3, .azimuth_deg = 90.0};
        CHECK_THAT(warning(), curved);
        bone.shape = Box{{5e-3, c.domain.extent_y_m(), 4e-3}};
        CHECK_THAT(warning(), with_edges);
    }
    SECTION("and only if the case requests the stress") {
        c.afferents.reset();
        CHECK(spectral::receptors_near_bodies(c).empty());
    }
}

} // namespace test_rigid_choice
