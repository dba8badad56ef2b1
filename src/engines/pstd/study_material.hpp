// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/pstd/scheme/material.hpp"
#include "problem/case/study_data.hpp"

namespace shearwake::pstd {

/// The material of each node of a study, which must exist as long as the function.
MaterialOfNode material_of(const StudyData& study);

/// Whether the material differs between nodes.
bool is_uneven(const StudyData& study);

} // namespace shearwake::pstd
