// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"
#include "support/cases.hpp"
#include "support/on_root.hpp"

#include <array>
#include <map>
#include <vector>

namespace shearwake::test {

/// Stores the stress that an engine passes to receptors, on this rank's slab.
class StressStore : public IgnoringObserver {
public:
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void stress(const engines::StressFrame& frame) override {
        std::vector<double> values;
        for (std::ptrdiff_t i = 0; i < frame.compression_Pa.rows(); ++i) {
            const auto row = frame.compression_Pa.row(i);
            values.insert(values.end(), row.begin(), row.end());
        }
        stresses_[key(frame.number, frame.depth)] = std::move(values);
    }
    const engines::Slab& slab() const { return slab_; }
    std::size_t planes() const { return stresses_.size(); }
    const std::vector<double>& at(std::ptrdiff_t number, std::size_t depth) const {
        return stresses_.at(key(number, depth));
    }
    /// Replaces the stresses by those of the root. Collective.
    void take_from_root(const Comm& world) { broadcast(stresses_, world); }

private:
    using Key = std::array<long, 2>;
    static Key key(std::ptrdiff_t number, std::size_t depth) {
        return {static_cast<long>(depth), number};
    }
    engines::Slab slab_;
    std::map<Key, std::vector<double>> stresses_;
};

/// All receptor stresses of a case, computed on this rank alone.
inline StressStore stresses_of(const Case& c) {
    StressStore store;
    engines::make_engine(c.solver)->run(c, Comm::world().split(Comm::world().rank()), store);
    return store;
}
/// The same, computed on the root. Collective.
inline StressStore stresses_of_root(const Case& c, const Comm& world) {
    StressStore store;
    on_root_alone(world,
                  [&](const Comm& alone) { engines::make_engine(c.solver)->run(c, alone, store); });
    store.take_from_root(world);
    return store;
}

} // namespace shearwake::test
