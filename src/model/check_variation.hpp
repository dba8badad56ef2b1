#pragma once

#include "model/check.hpp"

namespace shearwake {

/// The part of `check` about bodies and maps: engines that know none, bodies that the grid does not
/// resolve or the periodic edges cut, maps beside the domain.
std::vector<Remark> check_variation(const Case& c);

} // namespace shearwake
