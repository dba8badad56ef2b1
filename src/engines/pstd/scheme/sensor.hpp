// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/engine.hpp"
#include "engines/pstd/scheme/stepper.hpp"
#include "problem/case/study_data.hpp"

namespace shearwake::pstd {

/// Records some fields at some nodes of a grid study in every step; each node is recorded by the
/// rank that has it. All member functions except `add` are collective.
class Sensor {
public:
    Sensor(const StudyData& study, const Slabs& slabs);

    template <class Real>
    void add(const Stepper<Real>& stepper); // after every step; not collective

    /// The series in the study's order of nodes, on the root; empty on other ranks.
    std::vector<engines::SensorSeries> series(const Comm& team) const;
    void save(StateWriter& state) const;
    void restore(const StateReader& state);

private:
    DistributedRows rows() const;
    double* of(std::size_t field, std::size_t node) {
        return values_[field].data() + static_cast<std::ptrdiff_t>(node) * samples_;
    }

    const StudyData& study_;
    std::ptrdiff_t samples_ = 0;
    std::vector<std::size_t> order_; // the study's nodes sorted by x, contiguous for each rank
    std::size_t first_ = 0, count_ = 0;
    std::vector<std::ptrdiff_t> offsets_;     // of this rank's nodes in its slab
    std::vector<std::vector<double>> values_; // [field][node of this rank][sample]
};

} // namespace shearwake::pstd
