#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/stepper.hpp"
#include "model/grid_study.hpp"

namespace shearwake::pstd {

/// What a study's sensor hears: some fields at some nodes in every step, each node kept by the rank
/// that has it. All members but `add` are collective.
class Sensor {
public:
    Sensor(const GridStudy& study, const Slabs& slabs);

    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective

    /// In the study's order of nodes, on the root; elsewhere empty.
    std::vector<SensorSeries> series(const Comm& team) const;
    void save(StateWriter& state) const;
    void restore(StateReader& state);

private:
    StateRows rows() const;
    double* of(std::size_t field, std::size_t node) {
        return values_[field].data() + static_cast<std::ptrdiff_t>(node) * samples_;
    }

    const GridStudy& study_;
    std::ptrdiff_t samples_ = 0;
    std::vector<std::size_t> order_; // the study's nodes, sorted by x: whole ranges a rank
    std::size_t first_ = 0, count_ = 0;
    std::vector<std::ptrdiff_t> offsets_;     // of this rank's nodes, in its slab
    std::vector<std::vector<double>> values_; // [field][node of this rank][sample]
};

} // namespace shearwake::pstd
