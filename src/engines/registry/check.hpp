// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/plan.hpp"

#include <fmt/format.h>
#include <string>
#include <utility>
#include <vector>

namespace shearwake {

/// Collects remarks, with lengths in mm and times in ms as in the job.
struct Notes {
    std::vector<Remark> remarks;

    template <class... Args>
    void add(Severity severity, const char* key, fmt::format_string<Args...> format,
             Args&&... args) {
        remarks.push_back({severity, key, fmt::format(format, std::forward<Args>(args)...)});
    }
};

/// Everything about the physics of a case that is doubtful (warning) or makes the result
/// meaningless (error): resolution of the focus and of the shear wave, a focus that leaves the
/// domain, waves that wrap around within the run, periods that do not fit, times off the run, and
/// the limits of the engine. Not collective.
std::vector<Remark> check(const Case& c);

/// How the files of a case were read and what they contain, for the user. Not collective.
std::vector<std::string> files_read(const Case& c);

/// Whether image_uplift_m() applies: periodic edges and a force. A prescribed motion has an unknown
/// one.
bool has_image_uplift(const Case& c);

/// The largest uplift in a case, for the user; empty without one. Takes at most about .3 s. Not
/// collective.
std::string image_uplift_text(const Case& c);

/// The part of `check` about values that are possible but were probably given in another unit, or
/// for which the model does not hold: pressures, lengths, times, and pointers that move fast. Not
/// collective.
std::vector<Remark> check_plausibility(const Case& c);

/// The part of `check` about bodies and maps: bodies that the grid does not resolve or that cross
/// the periodic edges, and maps outside the domain.
std::vector<Remark> check_variation(const Case& c);

} // namespace shearwake
