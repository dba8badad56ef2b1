// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "config/document/tree.hpp"

#include <string>
#include <vector>

namespace shearwake::config {

/// A key that takes several values.
struct SweptKey {
    std::string key; // as written in the job
    Path path;
    Place at;
    std::vector<NodePtr> values;
};

/// Keys that change together: value i of each at the same time.
struct Axis {
    std::vector<SweptKey> keys;
    std::size_t size() const { return keys.front().values.size(); }
};

/// A combination of values that is excluded.
struct Exclusion {
    Place at;
    std::vector<std::pair<std::string, NodePtr>> values; // of swept keys
};

/// [sweep]: all combinations of the axes, with the first axis slowest.
struct Sweep {
    Place at;
    bool sound = true; // no error was found
    std::vector<Axis> axes;
    std::vector<Exclusion> exclusions;

    std::vector<std::string> keys() const; // in the order of the job
    bool holds(std::string_view key) const;
};

/// [sweep] with one entry per swept key, independent of how its dots were written: `"a.b" = [1]`,
/// `a.b = [1]` and `[sweep.a]` with `b = [1]` give the same result.
NodePtr flattened_sweep(const NodePtr& sweep);

/// Reads a flattened [sweep].
Sweep read_sweep(const NodePtr& sweep, DiagnosticList& diagnostics);

} // namespace shearwake::config
