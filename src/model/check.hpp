#pragma once

#include "model/case.hpp"

#include <string>
#include <vector>

namespace shearwake {

enum class Severity { warning, error };

/// Something about a case that its user should know. `key` is the job key to change.
struct Remark {
    Severity severity = Severity::warning;
    std::string key;
    std::string message;
    bool operator==(const Remark&) const = default;
};

/// Everything about the physics of a case that is doubtful (warning) or makes the result
/// meaningless (error): resolution of the focus and of the shear wave, a focus that leaves the
/// domain, waves that wrap around within the run, periods that do not fit, times off the run.
std::vector<Remark> check(const Case& c);

} // namespace shearwake
