// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace shearwake::app {

/// Commands whose library may be missing when the program is built.
enum class OptionalCommand { fit, optimise };

/// Throws UsageError if the program was built without the library of the command.
void require_library(OptionalCommand command);

/// The versions of the program and its libraries, and the commands that this build lacks.
std::string full_version_text();

} // namespace shearwake::app
