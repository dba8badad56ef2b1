// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/bounds.hpp"

#include "base/units.hpp"

#include <array>
#include <utility>

namespace shearwake::config {
namespace {

constexpr PhysicalBounds wave_speed{1e-3, 2e4,
                                    "shear waves travel at some mm/s in the softest gels, and no "
                                    "material carries waves faster than diamond, 18 km/s"};

constexpr std::array by_quantity = {
    std::pair{
        std::string_view("length"),
        PhysicalBounds{1e-12, 10.0, "atoms are 0.1 nm apart, and no human is longer than 10 m"}},
    std::pair{
        std::string_view("speed"),
        PhysicalBounds{1e-9, 1e6, "a faster focus would cross any patch of skin within 1 us"}},
    std::pair{std::string_view("density"),
              PhysicalBounds{1e-2, 3e4, "hydrogen has 0.09 kg/m3 and osmium 22 600 kg/m3"}},
    std::pair{std::string_view("viscosity"),
              PhysicalBounds{
                  1e-9, 1e6,
                  "gases have 1e-5 Pa s, and pitch, which feels solid, has more than 1e6 Pa s"}},
    std::pair{
        std::string_view("time"),
        PhysicalBounds{1e-12, 1e4, "molecules collide within 1 ps, and no study lasts hours"}},
    std::pair{std::string_view("frequency"),
              PhysicalBounds{1e-6, 1e9, "waves above 1 GHz do not propagate in tissue"}},
    std::pair{std::string_view("strength"),
              PhysicalBounds{1e-9, 1e5,
                             "a piston of 1e5 Pa m would produce the pressure of the atmosphere "
                             "at a distance of 1 m"}},
};

} // namespace

std::optional<PhysicalBounds> physical_bounds(std::string_view key) {
    const std::string_view name = without_unit(key);
    if (name.ends_with("c_s") || name.ends_with("c_p")) return wave_speed;
    const auto unit = unit_of(key);
    if (!unit) return std::nullopt;
    for (const auto& [quantity, bounds] : by_quantity)
        if (quantity == unit->quantity) return bounds;
    return std::nullopt;
}

std::string_view instead_of_zero(std::string_view key, std::string_view kind) {
    if (key == "am_frequency_Hz" && kind != "AM-STM")
        return "for a constant amplitude, set am_depth = 0";
    if (key == "am_frequency_Hz")
        return "for a case without modulation, set am_depth = 0, or use kind = \"STM\" instead of "
               "\"AM-STM\"; a sweep is compared with it by reference = { kind = \"STM\" } in "
               "[table]";
    if (key == "sm_frequency_Hz") return "for a constant speed, use kind = \"STM\"";
    if (key == "lm_frequency_Hz")
        return "for a focus that does not move, use kind = \"AM\" with am_depth = 0";
    return {};
}

} // namespace shearwake::config
