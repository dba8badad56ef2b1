#pragma once

#include "engines/spectral/lanes.hpp"

namespace shearwake {

/// Symmetric positive definite band matrices of eight wavenumbers side by side: the lower band, row
/// by row, matrix[row * band + (column - row + band - 1)]; `band` counts the diagonal.

/// L D L^T in place, lanes apart; the diagonal then holds 1 / D.
void factorise(std::ptrdiff_t unknowns, std::ptrdiff_t band, Lanes* matrix);

/// Solves A x = b for the four parts in place, x[unknown][part].
void solve(std::ptrdiff_t unknowns, std::ptrdiff_t band, const Lanes* factor, Lanes* x);

} // namespace shearwake
