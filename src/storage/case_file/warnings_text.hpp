// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "problem/case/remark.hpp"

#include <string>
#include <vector>

namespace shearwake::storage {

/// The attribute `warnings` of a case file: a JSON array of {severity, key, message}. The severity
/// "error" marks a case whose readings are not valid.
std::string warnings_text(const std::vector<Remark>& warnings);

/// The warnings in such a text; none if it is not valid.
std::vector<Remark> warnings_in(const std::string& text);

} // namespace shearwake::storage
