// SPDX-License-Identifier: BSD-3-Clause
#include "config/document/key_range.hpp"

#include "base/units.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace shearwake::config {
namespace {

/// In SI units.
struct PhysicalBounds {
    double least; // smallest magnitude other than 0
    double most;
    std::string_view why;
};

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

/// Nothing for numbers without a unit and for quantities without bounds.
const PhysicalBounds* physical_bounds(std::string_view key, const std::optional<Unit>& unit) {
    if (!unit) return nullptr;
    const std::string_view name = key.substr(0, key.size() - unit->suffix.size());
    if (name.ends_with("c_s") || name.ends_with("c_p")) return &wave_speed;
    for (const auto& [quantity, bounds] : by_quantity)
        if (quantity == unit->quantity) return &bounds;
    return nullptr;
}

/// A bound, which is a whole number or the inverse of one, in a unit. All steps but the last are
/// exact, so that the result is the double closest to 1e-9 and not its neighbour.
double in_unit(double bound, const Unit& unit) {
    const double inverse = std::round(1.0 / bound), per_SI = std::round(1.0 / unit.to_SI);
    if (unit.to_SI < 1.0) return bound < 1.0 ? per_SI / inverse : bound * per_SI;
    return bound < 1.0 ? 1.0 / (inverse * unit.to_SI) : bound / unit.to_SI;
}

} // namespace

bool KeyRange::contains(double value) const {
    return range.contains(value) && (value == 0.0 || std::abs(value) >= least_size);
}

std::string KeyRange::words() const {
    if (least_size == 0.0) return range.words();
    if (range.least == 0.0)
        return "0 or " + Range{least_size, range.most, false, range.most_excluded}.words();
    if (range.least == -range.most)
        return fmt::format("0 or between {} and {} in magnitude", least_size, range.most);
    return fmt::format("{}, and 0 or at least {} in magnitude", range.words(), least_size);
}

KeyRange key_range(std::string_view key, const Range& declared) {
    KeyRange allowed{declared};
    const auto unit = unit_of(key);
    const PhysicalBounds* bounds = physical_bounds(key, unit);
    if (!bounds) return allowed;
    const double least = in_unit(bounds->least, *unit), most = in_unit(bounds->most, *unit);
    allowed.why = bounds->why;
    Range& range = allowed.range;
    if (range.most > most) {
        range.most = most;
        range.most_excluded = false;
    }
    if (range.least < -most) {
        range.least = -most;
        range.least_excluded = false;
    }
    if (range.contains(0.0)) {
        allowed.least_size = least;
    } else if (range.least >= 0.0 && range.least < least) {
        range.least = least;
        range.least_excluded = false;
    }
    return allowed;
}

std::vector<std::string> words_of(const Field& field) {
    const std::string type = field.type;
    const std::size_t list = type.find("word:");
    if (list == std::string::npos) return {};
    std::vector<std::string> words;
    for (std::size_t at = list + 5, end = 0; end != std::string::npos; at = end + 1) {
        end = type.find('|', at);
        words.push_back(type.substr(at, end == std::string::npos ? end : end - at));
    }
    return words;
}

} // namespace shearwake::config
