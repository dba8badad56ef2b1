// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "pipeline/observers/recording.hpp"

#include <vector>

namespace shearwake::pipeline {

/// The displacement along the line of sight of a vibrometer at the points of its scan, averaged
/// over the spot, at every frame.
class ScanSeries : public Recording {
public:
    ScanSeries(const Case& c, const Comm& team);
    void begin(const engines::Slab& slab) override { slab_ = slab; }
    void frame(const engines::Frame& frame) override;
    void tangential(const engines::TangentialFrame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// One row of frames per point [m]; empty without a vibrometer.
    const std::vector<double>& displacements_m() const { return displacements_m_; }

private:
    void add(std::ptrdiff_t number, double factor, View2<const double> values);

    const Case& case_;
    const Comm& team_;
    engines::Slab slab_;
    std::vector<double> displacements_m_;
};

} // namespace shearwake::pipeline
