#pragma once

#include "model/case.hpp"

#include <string>

namespace shearwake {

/// In what a case does not fit the grid study that its solver names: domain, times, depths, and
/// what does nothing beside one. Empty: it fits, or names none.
std::string study_trouble(const Case& c);

} // namespace shearwake
