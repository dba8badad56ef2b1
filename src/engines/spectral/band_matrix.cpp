#include "engines/spectral/band_matrix.hpp"

#include <algorithm>

namespace shearwake {

void factorise(std::ptrdiff_t unknowns, std::ptrdiff_t band, Lanes* matrix) {
    // row(i)[j] is the entry (i, j).
    const auto row = [&](std::ptrdiff_t i) { return matrix + i * band + (band - 1 - i); };
    for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
        Lanes* mine = row(i);
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        for (std::ptrdiff_t j = first; j < i; ++j) { // L_ij D_j
            const Lanes* other = row(j);
            Lanes sum = mine[j];
            const std::ptrdiff_t common = std::max(first, j - band + 1);
            for (std::ptrdiff_t m = common; m < j; ++m)
                sum -= mine[m] * other[m];
            mine[j] = sum;
        }
        Lanes diagonal = mine[i];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = mine[j] * row(j)[j];
            diagonal -= l * mine[j];
            mine[j] = l;
        }
        mine[i] = 1.0 / diagonal;
    }
}

void solve(std::ptrdiff_t unknowns, std::ptrdiff_t band, const Lanes* factor, Lanes* x) {
    for (std::ptrdiff_t i = 0; i < unknowns; ++i) {
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        const Lanes* row = factor + i * band + band - 1 - i;
        Lanes a = x[i * parts], b = x[i * parts + 1], c = x[i * parts + 2], d = x[i * parts + 3];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = row[j];
            a -= l * x[j * parts];
            b -= l * x[j * parts + 1];
            c -= l * x[j * parts + 2];
            d -= l * x[j * parts + 3];
        }
        x[i * parts] = a;
        x[i * parts + 1] = b;
        x[i * parts + 2] = c;
        x[i * parts + 3] = d;
    }
    for (std::ptrdiff_t i = 0; i < unknowns; ++i)
        for (std::ptrdiff_t part = 0; part < parts; ++part)
            x[i * parts + part] *= factor[i * band + band - 1];
    for (std::ptrdiff_t i = unknowns; i-- > 0;) {
        const std::ptrdiff_t first = std::max<std::ptrdiff_t>(0, i - band + 1);
        const Lanes* row = factor + i * band + band - 1 - i;
        const Lanes a = x[i * parts], b = x[i * parts + 1], c = x[i * parts + 2],
                    d = x[i * parts + 3];
        for (std::ptrdiff_t j = first; j < i; ++j) {
            const Lanes l = row[j];
            x[j * parts] -= l * a;
            x[j * parts + 1] -= l * b;
            x[j * parts + 2] -= l * c;
            x[j * parts + 3] -= l * d;
        }
    }
}

} // namespace shearwake
