// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>

namespace shearwake::pstd {

/// Values that keep their split parts: [begin, end) of a row. Where the layers of two or three axes
/// meet, all parts but the first are kept: from `offset` on in the first array of parts, from
/// `second` on in the second one. Where one axis alone has its layer (`face`), all parts but that
/// axis' have the same factor and move as one: that axis' part is kept, if the field has it, from
/// `offset` on in the first array.
struct SplitRun {
    std::ptrdiff_t begin = 0, end = 0;
    std::ptrdiff_t offset = 0, second = 0;
    int face = -1; // an axis; -1: none
};

/// The layer's factors of a part in a row: that of x and y, and those of z.
template <class Real>
struct RowFactor {
    Real xy;
    const Real* z;
};

/// A field's row of z: its totals, the arrays of its kept parts, and the runs that keep them. Parts
/// come in the order of parts_of; `axes` are their axes.
template <class Real>
struct FieldRow {
    std::ptrdiff_t nz;
    Real* total;
    Real* part[2];
    RowFactor<Real> factor[3];
    int axes[3];
    const SplitRun *first_run, *last_run;
};

/// dt times the rate of a part at z: k[z] e[z], with Kelvin-Voigt + v[z] de[z].
template <class Real>
struct Rate {
    const Real *k, *e;
    const Real *v, *de;
};

/// Updates of a row, F_a <- Q_a (Q_a F_a + r_a) for each part a, and of the parts' sum where all Q
/// are 1.
template <class Real>
struct UpdateKernels {
    /// Three parts with r_a = c[z] g_a[z]; where `acceleration` is given it becomes their sum.
    void (*velocity)(const FieldRow<Real>& row, const Real* c, const Real* const g[3],
                     Real* acceleration);
    /// Three and two parts.
    void (*normal)(const FieldRow<Real>& row, const Rate<Real> rates[3]);
    void (*normal_lossy)(const FieldRow<Real>& row, const Rate<Real> rates[3]);
    void (*shear)(const FieldRow<Real>& row, const Rate<Real> rates[2]);
    void (*shear_lossy)(const FieldRow<Real>& row, const Rate<Real> rates[2]);
};

} // namespace shearwake::pstd
