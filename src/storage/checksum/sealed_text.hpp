// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace shearwake::storage {

/// A JSON object with its own checksum as last member: `{...}` becomes `{...,"checksum":"<16
/// hexadecimal digits>"}`, XXH3-64 of the text without that member. Text after the object (the end
/// of a line) is preserved.

/// `text` must end in a JSON object with members, and white space.
std::string seal(std::string_view text);

/// The text without its checksum; none if the checksum is missing or does not match.
std::optional<std::string> unseal(std::string_view text);

} // namespace shearwake::storage
