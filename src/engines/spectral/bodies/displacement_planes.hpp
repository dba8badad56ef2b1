// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/spectral/bodies/endless_systems.hpp"
#include "engines/spectral/kernels/displacements.hpp"
#include "engines/spectral/lateral/strain_planes.hpp"

namespace shearwake::spectral {

/// Planes of the displacement or the force along x, y and z at some depths, restricted to some of
/// their points, and their transfers to and from pencils. Values are stored as
/// [depth][component][cell].
class DisplacementPlanes {
public:
    static constexpr std::size_t components = 3;
    using Runs = std::vector<std::vector<fft::RowRun>>; // per depth, with offsets from 0
    /// `slabs` must outlive this object. Collective.
    DisplacementPlanes(std::vector<DepthWeights> depths, Runs runs, const DepthMesh& mesh,
                       const WaveVectors& vectors, const fft::SlabTransform& slabs,
                       const Comm& team);
    DisplacementPlanes(const DisplacementPlanes&) = delete;
    DisplacementPlanes& operator=(const DisplacementPlanes&) = delete;

    /// Index of the first value of a depth, the number of its cells, and the number of all values.
    std::size_t first(std::size_t depth) const { return points_[depth].first * components; }
    std::size_t cells(std::size_t depth) const { return points_[depth].cells; }
    std::size_t size() const;
    double memory_B() const { return planes_->memory_B(); }

    /// Between get() and end_row() of all rows: writes the displacement of a pencil. Not
    /// collective.
    void evaluate(std::ptrdiff_t row, std::ptrdiff_t block, const Block* pencil);
    /// Ends a row from the depth `from` on. Not collective.
    void end_row(std::ptrdiff_t row, std::size_t from = 0);
    /// Adds `scale` times the forces to a pencil, after begin_row(). Not collective.
    void begin_row(std::ptrdiff_t row) { planes_->begin_row(row); }
    void add_force(std::ptrdiff_t row, std::ptrdiff_t block, double scale, Block* pencil);
    /// Adds a unit force at the first point of the grid, times `scale`. Not collective.
    void add_unit(std::ptrdiff_t row, std::ptrdiff_t block, std::size_t depth,
                  std::size_t component, double scale, Block* pencil) const;
    /// Sets the planes from the values, or reads those of the depths from `from` on. Collective.
    void set(const std::vector<double>& values) { planes_->set(values); }
    void get(std::vector<double>& values, std::size_t from = 0) { planes_->get_from(from, values); }

private:
    DisplacementArrays arrays() const;

    const DisplacementKernels& kernels_;
    WaveVectors vectors_;
    std::ptrdiff_t nodes_, levels_;
    std::vector<DepthWeights> depths_;
    std::vector<DisplacementDepth> places_;
    std::vector<PlaneCells::Point> points_;
    std::vector<double> unit_; // spectra of x, y and z, of which one is 1
    std::optional<StrainPlanes> planes_;
};

} // namespace shearwake::spectral
