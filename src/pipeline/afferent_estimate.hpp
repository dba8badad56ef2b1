// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/work.hpp"
#include "problem/case/case.hpp"

#include <vector>

namespace shearwake::pipeline {

/// The work of all ranks for the afferents of a case; none without afferents.
std::vector<engines::Work> receptors_work(const Case& c);
/// Cases that determine its rates.
std::vector<engines::Calibration> receptor_calibrations();

/// Memory per rank for the afferents of a case, in addition to the engine [B].
double afferents_memory_B(const Case& c, int ranks);
/// Size of their groups in the case file, for the average number of spikes under vibration [B].
double afferents_file_B(const Case& c);

} // namespace shearwake::pipeline
