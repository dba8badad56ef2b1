#include "engines/spectral/skyline_matrix.hpp"

#include <algorithm>

namespace shearwake {
namespace {

/// The four parts of an unknown.
struct Value {
    Lanes part[parts];
};

inline Value load(const Lanes* x) {
    Value v;
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        v.part[p] = x[p];
    return v;
}
inline void store(const Value& v, Lanes* x) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        x[p] = v.part[p];
}
inline void subtract(Lanes factor, const Value& x, Value& from) {
    for (std::ptrdiff_t p = 0; p < parts; ++p)
        from.part[p] -= factor * x.part[p];
}

} // namespace

SkylineMatrix::SkylineMatrix(std::ptrdiff_t levels, std::ptrdiff_t degree,
                             std::ptrdiff_t per_level) {
    for (std::ptrdiff_t level = 0; level < levels; ++level) {
        const std::ptrdiff_t element = std::max<std::ptrdiff_t>(level - 1, 0) / degree;
        for (std::ptrdiff_t i = 0; i < per_level; ++i) {
            const std::ptrdiff_t first = element * degree * per_level;
            rows_.push_back({first, entries_ - first});
            entries_ += level * per_level + i - first + 1;
        }
    }
}

void SkylineMatrix::factorise(Lanes* matrix) const {
    for (std::ptrdiff_t i = 0; i < rows(); ++i) {
        Lanes* mine = matrix + row(i).start;
        for (std::ptrdiff_t j = row(i).first; j < i; ++j) { // L_ij D_j
            const Lanes* other = matrix + row(j).start;
            Lanes sum = mine[j];
            for (std::ptrdiff_t m = std::max(row(i).first, row(j).first); m < j; ++m)
                sum -= mine[m] * other[m];
            mine[j] = sum;
        }
        Lanes diagonal = mine[i];
        for (std::ptrdiff_t j = row(i).first; j < i; ++j) {
            const Lanes l = mine[j] * at(matrix, j, j);
            diagonal -= l * mine[j];
            mine[j] = l;
        }
        mine[i] = 1.0 / diagonal;
    }
}

void SkylineMatrix::solve(const Lanes* factor, Lanes* x) const {
    for (std::ptrdiff_t i = 0; i < rows(); ++i) {
        const Lanes* l = factor + row(i).start;
        Value a = load(x + i * parts);
        if (i + 1 == rows() || !pairs_with_row_above(i + 1)) {
            for (std::ptrdiff_t j = row(i).first; j < i; ++j)
                subtract(l[j], load(x + j * parts), a);
            store(a, x + i * parts);
            continue;
        }
        const Lanes* l_below = factor + row(i + 1).start;
        Value below = load(x + (i + 1) * parts);
        for (std::ptrdiff_t j = row(i).first; j < i; ++j) {
            const Value known = load(x + j * parts);
            subtract(l[j], known, a);
            subtract(l_below[j], known, below);
        }
        subtract(l_below[i], a, below);
        store(a, x + i * parts);
        store(below, x + ++i * parts);
    }
    for (std::ptrdiff_t i = 0; i < rows(); ++i)
        for (std::ptrdiff_t p = 0; p < parts; ++p)
            x[i * parts + p] *= factor[row(i).start + i];
    for (std::ptrdiff_t i = rows(); i-- > 0;) {
        const Lanes* l = factor + row(i).start;
        const Value a = load(x + i * parts);
        if (!pairs_with_row_above(i)) {
            for (std::ptrdiff_t j = row(i).first; j < i; ++j) {
                Value open = load(x + j * parts);
                subtract(l[j], a, open);
                store(open, x + j * parts);
            }
            continue;
        }
        const Lanes* l_above = factor + row(i - 1).start;
        Value above = load(x + (i - 1) * parts);
        subtract(l[i - 1], a, above);
        store(above, x + --i * parts);
        for (std::ptrdiff_t j = row(i).first; j < i; ++j) {
            Value open = load(x + j * parts);
            subtract(l[j], a, open);
            subtract(l_above[j], above, open);
            store(open, x + j * parts);
        }
    }
}

Lanes SkylineMatrix::quadratic_form(const Lanes* factor, Lanes* x, const Lanes* counted) const {
    Lanes sum{};
    for (std::ptrdiff_t i = 0; i < rows(); ++i) { // x becomes L^T x: columns above are still due
        const Lanes* l = factor + row(i).start;
        for (std::ptrdiff_t p = 0; p < parts; ++p)
            for (std::ptrdiff_t j = row(i).first; j < i; ++j)
                x[j * parts + p] += l[j] * x[i * parts + p];
    }
    for (std::ptrdiff_t i = 0; i < rows(); ++i)
        for (std::ptrdiff_t p = 0; p < parts; ++p)
            sum += counted[p] * x[i * parts + p] * x[i * parts + p] / factor[row(i).start + i];
    return sum;
}

} // namespace shearwake
