// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/registry/make_engine.hpp"

#include <map>
#include <utility>
#include <vector>

namespace shearwake::test {

/// Stores the stress that an engine passes to receptors, on this rank's slab.
class StressStore : public engines::Observer {
public:
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void frame(const engines::Frame& /*frame*/) override {}
    void stress(const engines::StressFrame& frame) override {
        std::vector<double> values;
        for (std::ptrdiff_t i = 0; i < frame.compression_Pa.rows(); ++i) {
            const auto row = frame.compression_Pa.row(i);
            values.insert(values.end(), row.begin(), row.end());
        }
        stresses_[{frame.depth, frame.number}] = std::move(values);
    }
    const engines::Slab& slab() const { return slab_; }
    std::size_t planes() const { return stresses_.size(); }
    const std::vector<double>& at(std::ptrdiff_t number, std::size_t depth) const {
        return stresses_.at({depth, number});
    }

private:
    engines::Slab slab_;
    std::map<std::pair<std::size_t, std::ptrdiff_t>, std::vector<double>> stresses_;
};

/// All receptor stresses of a case, computed on this rank alone.
inline StressStore stresses_of(const Case& c) {
    StressStore store;
    engines::make_engine(c.solver)->run(c, Comm::world().split(Comm::world().rank()), store);
    return store;
}

} // namespace shearwake::test
