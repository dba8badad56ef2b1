// SPDX-License-Identifier: BSD-3-Clause
// The stress around rigid cylinders across the domain, under a load that varies along the axis.
#include "support/rigid_cases.hpp"
#include "support/volume_store.hpp"

#include <array>
#include <catch2/catch.hpp>
#include <cmath>

namespace test_cylinder_volumes {

using namespace shearwake;
using test::Along;

constexpr std::size_t components = 6;

/// The stress after 1 ms. The load crosses the cylinder at an angle.
static Case stress_case(Along axis) {
    Case c = test::bone_case(axis, 1.0);
    c.time.frames = 11;
    c.record.volumes_s = {c.time.frame_s(10)};
    c.record.volume_fields = {VolumeField::stress};
    return c;
}

static test::VolumeStore stresses(const Case& c) {
    return test::frames_of<test::VolumeStore>(c);
}

struct Difference {
    double largest = 0.0; // of the values
    double difference = 0.0;
};

/// The largest difference of each component at all points that `use` accepts.
/// `at` returns the place in the other volume.
template <class Use, class At>
static std::array<Difference, components>
differences(const Case& c, const test::VolumeStore& one, const test::VolumeStore& other,
            const std::array<std::size_t, components>& swapped, const Use& use, const At& at) {
    std::array<Difference, components> all;
    for (std::size_t k = 0; k < components; ++k)
        for (std::size_t level = 0; level < one.z_m().size(); ++level)
            for (std::ptrdiff_t i = 0; i < c.domain.nx; ++i)
                for (std::ptrdiff_t j = 0; j < c.domain.ny; ++j) {
                    if (!use(Vec3{c.domain.x_m(i), c.domain.y_m(j), one.z_m()[level]})) continue;
                    const double value =
                        one.at(0, 0, k, level)[static_cast<std::size_t>(i * c.domain.ny + j)];
                    const double same =
                        other.at(0, 0, swapped[k], level)[static_cast<std::size_t>(at(i, j))];
                    all[k].largest = std::max(all[k].largest, std::abs(value));
                    all[k].difference = std::max(all[k].difference, std::abs(value - same));
                }
    return all;
}

static bool everywhere(Vec3) {
    return true;
}

constexpr std::array<std::size_t, components> not_swapped = {0, 1, 2, 3, 4, 5};

TEST_CASE("the stress around a cylinder does not depend on the axis along which it lies",
          "[verify][extended]") {
    const Case c = stress_case(Along::x), other = stress_case(Along::y);
    const std::ptrdiff_t ny = other.domain.ny;
    // xx and yy, yz and xz exchange their places.
    for (const Difference& d :
         differences(c, stresses(c), stresses(other), {1, 0, 2, 4, 3, 5}, everywhere,
                     [&](std::ptrdiff_t i, std::ptrdiff_t j) { return j * ny + i; }))
        CHECK(d.difference < 1e-8 * d.largest); // rounding, which lambda/mu = 1e5 amplifies
}

TEST_CASE("the stress around a cylinder follows a load along the axis", "[verify][extended]") {
    const Case c = stress_case(Along::y);
    Case moved = c;
    constexpr std::ptrdiff_t points = 7;
    const double path_length_m = points * c.domain.spacing_m;
    test::travel_of(moved).path =
        Curve({-7e-3, 2e-3 + path_length_m}, {7e-3, 1e-3 + path_length_m});
    const std::ptrdiff_t ny = c.domain.ny;
    for (const Difference& d : differences(
             c, stresses(c), stresses(moved), not_swapped, everywhere,
             [&](std::ptrdiff_t i, std::ptrdiff_t j) { return i * ny + (j + points) % ny; }))
        CHECK(d.difference < 1e-8 * d.largest); // rounding
}

} // namespace test_cylinder_volumes
