// SPDX-License-Identifier: BSD-3-Clause
#pragma once

namespace shearwake::laboratory {

/// The factor between the standard error and half of the 95 % confidence interval: the quantile
/// 0.975 of Student's t distribution. `degrees` >= 1.
double half_width_95(double degrees);

} // namespace shearwake::laboratory
