// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

namespace shearwake::config {

/// The Markdown reference of all keys of a case, with one table per table of the job. It is
/// generated from the descriptions next to the structs (base/field.hpp). The site shows it.
std::string key_reference();

} // namespace shearwake::config
