// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/volume.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The commit that this program was built from.
std::string program_version();
std::string program_git_id();

/// Attributes that identify the program that wrote a file: version, git id, compiler, build type,
/// libraries, host.
std::vector<Attribute> program_attributes();

/// The lines of `shearwake --version`.
std::string version_text();

} // namespace shearwake::pipeline
