// SPDX-License-Identifier: BSD-3-Clause
#include "base/printable.hpp"

#include <algorithm>

namespace shearwake {
namespace {

/// Length in bytes of the control character at the start of the text; 0 if there is none.
std::size_t control_character(std::string_view text) {
    const auto at = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
    };
    if (at(0) < 0x20 || at(0) == 0x7f) return 1;
    if (at(0) == 0xc2 && at(1) >= 0x80 && at(1) <= 0x9f) return 2;
    if (at(0) != 0xe2) return 0;
    const bool turns = (at(1) == 0x80 && at(2) >= 0xaa && at(2) <= 0xae) ||
                       (at(1) == 0x81 && at(2) >= 0xa6 && at(2) <= 0xa9);
    return turns ? 3 : 0;
}

} // namespace

bool has_control_characters(std::string_view text) {
    for (std::size_t i = 0; i < text.size(); ++i)
        if (control_character(text.substr(i)) > 0) return true;
    return false;
}

std::string printable(std::string_view text) {
    std::string clean;
    for (std::size_t i = 0; i < text.size();) {
        const bool breaks = text[i] == '\n' || text.substr(i, 2) == "\r\n";
        const std::size_t length = breaks ? 0 : control_character(text.substr(i));
        clean += length > 0 ? '?' : text[i];
        i += std::max<std::size_t>(length, 1);
    }
    return clean;
}

} // namespace shearwake
