// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/volume.hpp"

#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>
#include <vector>

namespace shearwake::serve {

/// Version of the protocol (docs/reference/serve.md). A change that removes or renames a member, or
/// changes its meaning, increases it.
inline constexpr int protocol_version = 1;

/// The surface at all output times, [time][x][y] [m].
struct Frames {
    std::span<const float> u_z_m;
    std::ptrdiff_t count = 0, nx = 0, ny = 0;
};

/// Writes messages to the standard output. Not collective: rank 0 calls it.
class Output {
public:
    /// One line with a JSON object of type `type`, and its request unless it is negative.
    void message(const std::string& type, long request, const nlohmann::ordered_json& members);
    /// The message `error` with its code and its text for users.
    void error(long request, const std::string& code, const std::string& text);
    /// The message `result`: the members, the scalars and the list of arrays, followed by the bytes
    /// of the arrays and a newline.
    void result(long request, nlohmann::ordered_json members,
                const std::vector<VariableGroup>& groups, const Frames& frames);
    /// Whether the output cannot be written any more, for example because its reader has ended.
    bool has_failed() const;
};

} // namespace shearwake::serve
