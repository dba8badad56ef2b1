#pragma once

#include "engines/checkpoint.hpp"
#include "engines/spectral/lateral_variation.hpp"
#include "parallel/row_sums.hpp"

#include <utility>
#include <vector>

namespace shearwake {

/// Strains and stresses at the cells where the medium varies, [point][component][cell], and the
/// moduli that act on them. Not collective: sums are this rank's.
class LateralField {
public:
    using Values = std::vector<double>;
    LateralField(LateralVariation variation, std::ptrdiff_t ny, const SlabShare& share);

    const LateralVariation& variation() const { return variation_; }
    std::size_t size() const { return variation_.cells * static_cast<std::size_t>(components_); }

    /// Stress beyond that of the layers: for strain `now`, and its rate (now - before) * rate.
    void stress(const Values& now, const Values& before, double rate, Values& out) const;
    /// The implicit operator's part that is not the background's, at one point.
    void implicit(std::size_t point, const Values& strain, Values& out) const;
    /// The product of two fields at one point, by rows of x.
    void add_product(std::size_t point, const Values& a, const Values& b, RowSums& sums) const;
    std::size_t points() const { return variation_.points.size(); }
    /// Where a point's values lie.
    std::pair<std::size_t, std::size_t> range(std::size_t point) const {
        const LateralVariation::Point& at = variation_.points[point];
        return {at.first * components_, (at.first + at.cells) * components_};
    }

    /// Values as rows of whole planes, zero but for the cells, for a file: any number of ranks.
    StateRows rows(std::ptrdiff_t nx) const;
    std::vector<double> to_rows(const Values& values) const;
    void from_rows(const std::vector<double>& rows, Values& values) const;

private:
    LateralVariation variation_;
    std::size_t components_;
    std::ptrdiff_t ny_;
    SlabShare share_;
};

} // namespace shearwake
