#pragma once

#include "model/record.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// The commit that this program was built from.
std::string program_git_id();

/// What a file must say of the program that wrote it: version, git id, compiler, build type,
/// libraries, host.
std::vector<Attribute> program_attributes();

/// The lines of `shearwake --version`.
std::string version_text();

} // namespace shearwake
