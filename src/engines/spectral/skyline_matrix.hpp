#pragma once

#include "engines/spectral/lanes.hpp"

#include <cstddef>
#include <vector>

namespace shearwake {

/// Symmetric positive definite matrices of spectral elements in a row, eight wavenumbers side by
/// side. An unknown couples to those of its own element only, and what L D L^T fills in stays
/// there: of each row of the lower triangle the entries from its element's first unknown to the
/// diagonal are kept, half of what a band would hold.
class SkylineMatrix {
public:
    /// Elements of `degree`, `per_level` unknowns at each of the first `levels` levels.
    SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree, std::ptrdiff_t per_level);

    std::ptrdiff_t rows() const { return static_cast<std::ptrdiff_t>(rows_.size()); }
    std::ptrdiff_t entries() const { return entries_; } // of one matrix
    /// Entry (row, column), column from the first kept to `row`.
    Lanes& at(Lanes* matrix, std::ptrdiff_t row, std::ptrdiff_t column) const {
        return matrix[rows_[static_cast<std::size_t>(row)].start + column];
    }

    /// L D L^T in place, lanes apart; the diagonal then holds 1 / D.
    void factorise(Lanes* matrix) const;
    /// Solves A x = b for the four parts in place, x[unknown][part].
    void solve(const Lanes* factor, Lanes* x) const;
    /// x.A x of each lane, from the factor, the four parts weighted with `counted`. Overwrites x.
    Lanes quadratic_form(const Lanes* factor, Lanes* x, const Lanes* counted) const;

private:
    struct Row {
        std::ptrdiff_t first; // column kept
        std::ptrdiff_t start; // of column 0, were it kept
    };
    const Row& row(std::ptrdiff_t i) const { return rows_[static_cast<std::size_t>(i)]; }
    /// Whether a row and the one above begin at the same column: they are solved together, so that
    /// the unknowns are read once for both.
    bool pairs_with_row_above(std::ptrdiff_t i) const {
        return i > 0 && row(i).first == row(i - 1).first;
    }

    std::vector<Row> rows_;
    std::ptrdiff_t entries_ = 0;
};

} // namespace shearwake
