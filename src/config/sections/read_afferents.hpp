// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/reader.hpp"
#include "config/files/loaders.hpp"
#include "problem/case/case.hpp"

#include <optional>

namespace shearwake::config {

/// Reads [afferents]; nothing if the table is absent. The pins must lie inside the domain, if that
/// has an extent. If the job lists no pins, they follow the path or the foci of `load`; without a
/// load (null), there is one pin at the origin.
std::optional<AfferentOptions> read_afferents(Reader& reader, const Domain& domain,
                                              const Load* load, const TextLoader& load_text);

} // namespace shearwake::config
