// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/case.hpp"

namespace shearwake::pipeline {

/// Size of the case file in bytes, including the overhead of HDF5; `engine_B` of it is written by
/// the engine. Not collective.
double case_file_B(const Case& c, double engine_B);

} // namespace shearwake::pipeline
