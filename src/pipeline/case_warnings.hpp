// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"
#include "problem/case/remark.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// Mean of u_z^2 over the edges of the domain divided by its mean over the domain: the share of the
/// energy that waves carry beyond a periodic edge. `mean_u2` has the shape [nx][ny]. 0 without
/// motion. Not collective.
double edge_share(const Domain& domain, const std::vector<double>& mean_u2);

/// The warnings that are stored with a complete case: those of `check`, of the solver (`solver`)
/// and of the afferents (`afferents`, lines "key: message"). The computed mean of u_z^2 (empty:
/// unknown) decides on waves that may return through periodic edges. If they carry too much energy,
/// the severity is `error`: the readings are not valid. If they carry almost none, the warning is
/// omitted. Not collective.
std::vector<Remark> case_warnings(const Case& c, const std::vector<Remark>& solver,
                                  const std::vector<std::string>& afferents,
                                  const std::vector<double>& mean_u2);

} // namespace shearwake::pipeline
