// SPDX-License-Identifier: BSD-3-Clause
#include "base/units.hpp"

#include <array>

namespace shearwake {
namespace {

constexpr std::array units = {
    Unit{"_kg_m3", 1.0, "density"},  Unit{"_g_cm3", 1e3, "density"},
    Unit{"_m_s", 1.0, "speed"},      Unit{"_mm_s", 1e-3, "speed"},
    Unit{"_cm_s", 1e-2, "speed"},    Unit{"_km_s", 1e3, "speed"},
    Unit{"_Pa_s", 1.0, "viscosity"}, Unit{"_mPa_s", 1e-3, "viscosity"},
    Unit{"_kHz", 1e3, "frequency"},  Unit{"_Hz", 1.0, "frequency"},
    Unit{"_MHz", 1e6, "frequency"},  Unit{"_kPa", 1e3, "pressure"},
    Unit{"_MPa", 1e6, "pressure"},   Unit{"_Pa", 1.0, "pressure"},
    Unit{"_mm", 1e-3, "length"},     Unit{"_um", 1e-6, "length"},
    Unit{"_nm", 1e-9, "length"},     Unit{"_cm", 1e-2, "length"},
    Unit{"_m", 1.0, "length"},       Unit{"_ms", 1e-3, "time"},
    Unit{"_us", 1e-6, "time"},       Unit{"_ns", 1e-9, "time"},
    Unit{"_s", 1.0, "time"},         Unit{"_deg", 0.017453292519943295, "angle"},
    Unit{"_rad", 1.0, "angle"},      Unit{"_mN", 1e-3, "force"},
    Unit{"_N", 1.0, "force"},        Unit{"_dB_m", 1.0, "absorption"},
    Unit{"_Pa_m", 1.0, "strength"},
};

} // namespace

std::optional<Unit> unit_of(std::string_view key) {
    // That of the latest key, since long lists ask for each of their numbers.
    static std::string latest;
    static std::optional<Unit> found;
    if (key == latest) return found;
    latest = key;
    found.reset();
    if (key.find("_over_") != std::string_view::npos) return found; // a ratio
    for (const Unit& unit : units) {
        const bool longer = !found || unit.suffix.size() > found->suffix.size();
        if (longer && key.size() > unit.suffix.size() && key.ends_with(unit.suffix)) found = unit;
    }
    return found;
}

std::string_view without_unit(std::string_view key) {
    const auto unit = unit_of(key);
    return unit ? key.substr(0, key.size() - unit->suffix.size()) : key;
}

std::string key_in_SI(std::string_view key) {
    const auto given = unit_of(key);
    if (!given) return std::string(key);
    for (const Unit& unit : units)
        if (unit.quantity == given->quantity && unit.to_SI == 1.0)
            return std::string(without_unit(key)) + std::string(unit.suffix);
    return std::string(key);
}

} // namespace shearwake
