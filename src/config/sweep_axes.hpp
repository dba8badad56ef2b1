#pragma once

#include "config/tree.hpp"

#include <string>
#include <vector>

namespace shearwake {

/// A key that takes several values.
struct SweptKey {
    std::string key; // as the job spells it
    Path path;
    Place at;
    std::vector<NodePtr> values;
};

/// Keys that go together: value i of each at the same time.
struct Axis {
    std::vector<SweptKey> keys;
    std::size_t size() const { return keys.front().values.size(); }
};

/// Values that no case has together.
struct Exclusion {
    Place at;
    std::vector<std::pair<std::string, NodePtr>> values; // of swept keys
};

/// [sweep]: axes multiply, the first one slowest.
struct Sweep {
    Place at;
    bool sound = true; // there was no mistake in it
    std::vector<Axis> axes;
    std::vector<Exclusion> exclusions;

    std::vector<std::string> keys() const; // in the job's order
    bool holds(std::string_view key) const;
};

/// [sweep] with one entry for each swept key, however its dots were written: `"a.b" = [1]`,
/// `a.b = [1]` and `[sweep.a]` with `b = [1]` become the same.
NodePtr flattened_sweep(const NodePtr& sweep);

/// Reads a flattened [sweep].
Sweep read_sweep(const NodePtr& sweep, Diagnostics& findings);

} // namespace shearwake
