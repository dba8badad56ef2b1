// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/field.hpp"

namespace shearwake {

/// Engine `springs`: skin of independent springs.
struct SpringsOptions {
    static constexpr const char* name = "springs";
    double stiffness_Pa_m = 1e6; // pressure per displacement
    bool operator==(const SpringsOptions&) const = default;
};

template <class Walk, Is<SpringsOptions> Options>
void walk_fields(Walk& walk, Options& o) {
    walk(o.stiffness_Pa_m, {.key = "stiffness_Pa_m",
                            .range = Range::above(0.0),
                            .meaning = "pressure per displacement"});
}

} // namespace shearwake
