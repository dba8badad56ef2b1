// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "base/block.hpp"

namespace shearwake::spectral {

/// Operations on six components of strain or stress at the `cells` cells of one point,
/// [component][cell], with the moduli of the cells.
struct StrainKernels {
    /// Stress for the strain `now` and its rate (now - before) * rate.
    void (*stress)(std::ptrdiff_t cells, const double* lambda, const double* mu,
                   const double* viscosity, double rate, const double* now, const double* before,
                   double* stress);
    /// Elastic stress without viscosity.
    void (*elastic)(std::ptrdiff_t cells, const double* lambda, const double* mu,
                    const double* strain, double* stress);

    // Operations on vectors of `count` numbers.

    double (*product)(std::ptrdiff_t count, const double* a, const double* b);
    /// x += alpha * a and y -= alpha * b.
    void (*step)(std::ptrdiff_t count, double alpha, const double* a, const double* b, double* x,
                 double* y);
    /// x = a + beta * x.
    void (*turn)(std::ptrdiff_t count, double beta, const double* a, double* x);
    /// x = a - x.
    void (*subtract_from)(std::ptrdiff_t count, const double* a, double* x);
    /// before = 2 now - before + scale * change.
    void (*advance)(std::ptrdiff_t count, double scale, const double* now, const double* change,
                    double* before);
};

} // namespace shearwake::spectral
