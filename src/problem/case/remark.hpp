// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace shearwake {

enum class Severity { warning, error };

/// A warning or an error about a case. `key` is the job key to change.
struct Remark {
    Severity severity = Severity::warning;
    std::string key;
    std::string message;
    bool operator==(const Remark&) const = default;
};

} // namespace shearwake
