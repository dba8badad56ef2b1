#pragma once

#include "config/text_loader.hpp"
#include "config/sweep_axes.hpp"
#include "model/plan.hpp"

namespace shearwake {

/// Every case of the sweep, the first axis slowest, then the references. `base` is the whole job
/// as a tree; `reference` the keys of load.modulation that make a reference, or null. Also checks
/// the physics of every case. After a mistake in [sweep] only the first case is read.
std::vector<PlannedCase> expand(const NodePtr& base, const Sweep& sweep, const NodePtr& reference,
                                const FileLoaders& files, Diagnostics& findings);

} // namespace shearwake
