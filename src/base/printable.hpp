// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <string_view>

namespace shearwake {

/// Whether the text contains characters that a terminal would interpret: control characters of
/// ASCII, including line breaks, and of Unicode (U+0080 to U+009F), and characters that change the
/// direction of writing.
bool has_control_characters(std::string_view text);

/// The text with every such character replaced by a question mark. Line breaks ("\n" and "\r\n")
/// are kept.
std::string printable(std::string_view text);

} // namespace shearwake
