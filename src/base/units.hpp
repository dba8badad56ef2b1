#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shearwake {

/// A unit as it stands at the end of a key, and what one of it is in SI.
struct Unit {
    std::string_view suffix; // with its underscore: "_mm"
    double to_SI;
    std::string_view quantity; // units of one quantity can be mistaken for each other
};

/// The unit at the end of `key`, if it ends in one; the longest that fits.
std::optional<Unit> unit_of(std::string_view key);

/// `key` without its unit: "thickness_mm" -> "thickness".
std::string_view without_unit(std::string_view key);

} // namespace shearwake
