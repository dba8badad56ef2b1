// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "measures/summary.hpp"
#include "pipeline/observers/recording.hpp"

#include <string>
#include <vector>

namespace shearwake::pipeline {

/// The contribution of the rows of this rank to the value at a point of the plane, by cubic
/// Lagrange interpolation; the sum over the ranks is the value.
double value_at(Vec2 at_m, View2<const double> values, const Domain& domain,
                const engines::Slab& slab);

/// u_z at some points of the surface, at every frame: the traces of a case, or the pins of its
/// afferents.
class PointSeries : public Recording {
public:
    /// `name`: that of the series in checkpoints.
    PointSeries(const Case& c, const Comm& team, std::string name, const std::vector<Vec2>& at_m);
    void frame(const engines::Frame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    const std::vector<measures::TraceSeries>& series() const { return series_; }

private:
    std::string name_;
    std::vector<measures::TraceSeries> series_;
};

/// The stress at the receptors of a case [Pa], compression positive; 0 off the domain.
class ReceptorSeries : public Recording {
public:
    using Recording::Recording;
    /// Positions and, for each, the index of its depth. Call before the run. Collective.
    void record_at(const std::vector<Vec2>& at_m, std::vector<std::size_t> depths);
    void stress(const engines::StressFrame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    const std::vector<measures::TraceSeries>& series() const { return series_; }

private:
    std::vector<measures::TraceSeries> series_;
    std::vector<std::size_t> depths_; // of each
};

/// The displacement along the line of sight of a vibrometer at the points of its scan, averaged
/// over the spot, at every frame.
class ScanSeries : public Recording {
public:
    ScanSeries(const Case& c, const Comm& team);
    void frame(const engines::Frame& frame) override;
    void tangential(const engines::TangentialFrame& frame) override;
    void save(StateWriter& state) override;
    void restore(const StateReader& state) override;
    void finish() override;

    /// One row of frames per point [m]; empty without a vibrometer.
    const std::vector<double>& displacements_m() const { return displacements_m_; }

private:
    void add(std::ptrdiff_t number, double factor, View2<const double> values);

    std::vector<double> displacements_m_;
};

} // namespace shearwake::pipeline
