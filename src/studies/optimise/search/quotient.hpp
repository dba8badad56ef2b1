// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

#include <optional>
#include <string>
#include <vector>

namespace shearwake::optimise {

/// A column of the table that is a quotient of two quadratic forms of the displacement.
struct Quotient {
    enum class Kind {
        efficiency, // eta_period_1
        sharpness,  // sharpness_1
        share,      // share_{low}_{high}_1, of the trace at trace_m()
        velocity_share
    };
    Kind kind = Kind::efficiency;
    FrequencyBand band; // of a share
};

/// The quotients that the table of a case contains, as names of columns.
std::vector<std::string> quotients_of(const Case& c);

/// The quotient with this name; none if it is not one of quotients_of().
std::optional<Quotient> find_quotient(const Case& c, const std::string& column);

/// The trace of the spectral columns: that of the centre, or the first one.
Vec2 trace_m(const Case& c);

} // namespace shearwake::optimise
