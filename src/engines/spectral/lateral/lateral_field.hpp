// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "engines/checkpoint.hpp"
#include "engines/spectral/kernels/strains.hpp"
#include "engines/spectral/lateral/lateral_variation.hpp"
#include "parallel/comm.hpp"

#include <utility>
#include <vector>

namespace shearwake::spectral {

/// Strains and stresses at the cells where the medium varies, [point][component][cell], and the
/// moduli of these cells. Not collective; sums cover this rank only.
class LateralField {
public:
    using Values = std::vector<double>;
    LateralField(LateralVariation variation, std::ptrdiff_t ny, const fft::SlabShare& share);

    const LateralVariation& variation() const { return variation_; }
    std::size_t size() const { return variation_.cells * static_cast<std::size_t>(components_); }

    /// Stress in addition to that of the layers for the strain `now` and its rate (now - before) *
    /// rate.
    void stress(const Values& now, const Values& before, double rate, Values& out) const;
    /// Part of the implicit operator that is not contained in the background, at one point.
    void implicit(std::size_t point, const Values& strain, Values& out) const;
    /// Adds the product of two fields at one point to the sums of the rows of x.
    void add_product(std::size_t point, const Values& a, const Values& b, RowSums& sums) const;
    /// The cells that differ from the background. Valid for the lifetime of this object.
    PlaneCells cells() const {
        return {.points = variation_.points, .components = components_, .x_start = share_.x_start};
    }
    std::size_t points() const { return variation_.points.size(); }
    /// Range of the indices of a point's values.
    std::pair<std::size_t, std::size_t> range(std::size_t point) const {
        return cells().range(point);
    }

    /// Conversion to and from rows of complete planes, zero outside of the cells, for a checkpoint
    /// that can be read on any number of ranks.
    DistributedRows rows(std::ptrdiff_t nx) const;
    std::vector<double> to_rows(const Values& values) const;
    void read_rows(const std::vector<double>& rows, Values& values) const;

private:
    const StrainKernels& kernels_;
    LateralVariation variation_;
    std::size_t components_;
    std::ptrdiff_t ny_;
    fft::SlabShare share_;
};

} // namespace shearwake::spectral
