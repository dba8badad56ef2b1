// SPDX-License-Identifier: BSD-3-Clause
#include "engines/spectral/kernels/skyline.hpp"

#include "engines/spectral/kernels/slices.hpp"
#include "simd/kernels.hpp"

namespace shearwake::spectral {
namespace {

/// Matrix entries of row i, indexed by column.
[[gnu::always_inline]] inline const Block* entries(SkylineRows rows, const Block* matrix,
                                                   std::ptrdiff_t i) {
    return matrix + rows.row[i].start;
}

/// Whether a row and the one above it begin at the same column. Such rows are processed together,
/// so that the unknowns are read once for both.
[[gnu::always_inline]] inline bool pairs_with_row_above(SkylineRows rows, std::ptrdiff_t i) {
    return i > 0 && rows.row[i].first == rows.row[i - 1].first;
}

void factorise(SkylineRows rows, Block* matrix) {
    for (std::ptrdiff_t i = 0; i < rows.count; ++i) {
        const std::ptrdiff_t first = rows.row[i].first;
        Block* mine = matrix + rows.row[i].start;
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            for (std::ptrdiff_t j = first; j < i; ++j) { // L_ij D_j
                const Block* other = entries(rows, matrix, j);
                Vector sum = get(mine[j], s);
                const std::ptrdiff_t both = first > rows.row[j].first ? first : rows.row[j].first;
                for (std::ptrdiff_t m = both; m < j; ++m)
                    sum -= get(mine[m], s) * get(other[m], s);
                set(mine[j], s, sum);
            }
            Vector diagonal = get(mine[i], s);
            for (std::ptrdiff_t j = first; j < i; ++j) {
                const Vector l = get(mine[j], s) * get(entries(rows, matrix, j)[j], s);
                diagonal -= l * get(mine[j], s);
                set(mine[j], s, l);
            }
            set(mine[i], s, 1.0 / diagonal);
        }
    }
}

/// Solves L x = b from the first row downward, one or two rows at a time.
void forward(SkylineRows rows, const Block* factor, Block* x) {
    for (std::ptrdiff_t i = 0; i < rows.count; ++i) {
        const std::ptrdiff_t first = rows.row[i].first;
        const Block* l = entries(rows, factor, i);
        if (i + 1 == rows.count || !pairs_with_row_above(rows, i + 1)) {
            for (std::ptrdiff_t s = 0; s < slices; ++s) {
                Value a = get_parts(x + i * parts, s);
                for (std::ptrdiff_t j = first; j < i; ++j)
                    subtract(get(l[j], s), get_parts(x + j * parts, s), a);
                set_parts(x + i * parts, s, a);
            }
            continue;
        }
        const Block* l_below = entries(rows, factor, i + 1);
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            Value a = get_parts(x + i * parts, s), below = get_parts(x + (i + 1) * parts, s);
            for (std::ptrdiff_t j = first; j < i; ++j) {
                const Value known = get_parts(x + j * parts, s);
                subtract(get(l[j], s), known, a);
                subtract(get(l_below[j], s), known, below);
            }
            subtract(get(l_below[i], s), a, below);
            set_parts(x + i * parts, s, a);
            set_parts(x + (i + 1) * parts, s, below);
        }
        ++i;
    }
}

/// Solves D L^T x = b from the last row upward, one or two rows at a time.
void backward(SkylineRows rows, const Block* factor, Block* x) {
    for (std::ptrdiff_t i = rows.count; i-- > 0;) {
        const std::ptrdiff_t first = rows.row[i].first;
        const Block* l = entries(rows, factor, i);
        if (!pairs_with_row_above(rows, i)) {
            for (std::ptrdiff_t s = 0; s < slices; ++s) {
                const Value a = get_parts(x + i * parts, s);
                for (std::ptrdiff_t j = first; j < i; ++j) {
                    Value open = get_parts(x + j * parts, s);
                    subtract(get(l[j], s), a, open);
                    set_parts(x + j * parts, s, open);
                }
            }
            continue;
        }
        const Block* l_above = entries(rows, factor, i - 1);
        for (std::ptrdiff_t s = 0; s < slices; ++s) {
            const Value a = get_parts(x + i * parts, s);
            Value above = get_parts(x + (i - 1) * parts, s);
            subtract(get(l[i - 1], s), a, above);
            set_parts(x + (i - 1) * parts, s, above);
            for (std::ptrdiff_t j = first; j < i - 1; ++j) {
                Value open = get_parts(x + j * parts, s);
                subtract(get(l[j], s), a, open);
                subtract(get(l_above[j], s), above, open);
                set_parts(x + j * parts, s, open);
            }
        }
        --i;
    }
}

void solve(SkylineRows rows, const Block* factor, Block* x) {
    forward(rows, factor, x);
    for (std::ptrdiff_t i = 0; i < rows.count; ++i) {
        const Block& over_d = entries(rows, factor, i)[i];
        for (std::ptrdiff_t s = 0; s < slices; ++s)
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                set(x[i * parts + p], s, get(x[i * parts + p], s) * get(over_d, s));
    }
    backward(rows, factor, x);
}

Block quadratic_form(SkylineRows rows, const Block* factor, Block* x, const Block* counted) {
    Block form;
    for (std::ptrdiff_t s = 0; s < slices; ++s) {
        // Compute L^T x in place: row i contributes to the columns above.
        for (std::ptrdiff_t i = 0; i < rows.count; ++i) {
            const Block* l = entries(rows, factor, i);
            const Value mine = get_parts(x + i * parts, s);
            for (std::ptrdiff_t j = rows.row[i].first; j < i; ++j) {
                Value open = get_parts(x + j * parts, s);
                add(get(l[j], s), mine, open);
                set_parts(x + j * parts, s, open);
            }
        }
        Vector sum{};
        for (std::ptrdiff_t i = 0; i < rows.count; ++i) {
            const Value mine = get_parts(x + i * parts, s);
            for (std::ptrdiff_t p = 0; p < parts; ++p)
                sum += get(counted[p], s) * mine.part[p] * mine.part[p] /
                       get(entries(rows, factor, i)[i], s);
        }
        set(form, s, sum);
    }
    return form;
}

constexpr SkylineKernels table = {factorise, solve, quadratic_form};

} // namespace
} // namespace shearwake::spectral

template <>
const shearwake::spectral::SkylineKernels&
shearwake::simd::compiled<shearwake::spectral::SkylineKernels, shearwake::simd::this_set>() {
    return spectral::table;
}
