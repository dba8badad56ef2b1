#pragma once

#include "engines/engine.hpp"

#include <map>
#include <utility>
#include <vector>

namespace shearwake::test {

/// The stress that an engine gives to receptors, on this rank's slab.
class StressStore : public Observer {
public:
    void begin(const Slab& slab) override { slab_ = slab; }
    void frame(const Frame& /*frame*/) override {}
    void stress(const StressFrame& frame) override {
        std::vector<double> values;
        for (std::ptrdiff_t i = 0; i < frame.compression_Pa.rows(); ++i) {
            const auto row = frame.compression_Pa.row(i);
            values.insert(values.end(), row.begin(), row.end());
        }
        stresses_[{frame.depth, frame.number}] = std::move(values);
    }
    const Slab& slab() const { return slab_; }
    std::size_t planes() const { return stresses_.size(); }
    const std::vector<double>& at(std::ptrdiff_t number, std::size_t depth) const {
        return stresses_.at({depth, number});
    }

private:
    Slab slab_;
    std::map<std::pair<std::size_t, std::ptrdiff_t>, std::vector<double>> stresses_;
};

/// All of a case's, on this rank alone.
inline StressStore stresses_of(const Case& c) {
    StressStore store;
    make_engine(c.solver)->run(c, Comm::world().split(Comm::world().rank()), store);
    return store;
}

} // namespace shearwake::test
