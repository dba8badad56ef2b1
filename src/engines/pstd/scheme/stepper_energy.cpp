// SPDX-License-Identifier: BSD-3-Clause
#include "engines/pstd/scheme/stepper.hpp"

#include <algorithm>

namespace shearwake::pstd {

template <class Real>
double Stepper<Real>::kinetic_J() const {
    double sum = 0.0; // of v^2 dt/(dt/rho)
    for (std::size_t i = 0; i < 3; ++i) {
        const auto velocity = static_cast<Field>(i);
        // u_z of the plane above is between empty nodes and the medium.
        const std::ptrdiff_t first =
            std::max<std::ptrdiff_t>(velocity == Field::uz ? top_ - 1 : top_, 0);
        for (std::ptrdiff_t row = 0; row < slabs_.rows(); ++row) {
            const Real* v = state(velocity).total.data() + row * slabs_.pitch;
            const Real* dt_over_rho =
                coefficients_->dt_over_rho[i].row(row / slabs_.ny(), row % slabs_.ny());
            for (std::ptrdiff_t z = first; z < slabs_.nz(); ++z)
                sum += static_cast<double>(v[z] * v[z] / dt_over_rho[z]);
        }
    }
    return 0.5 * volume_m3() * slabs_.grid.dt_s * sum;
}

template <class Real>
double Stepper<Real>::elastic_J() const {
    double sum = 0.0; // of s_ij e_ij/dt
    for (std::ptrdiff_t row = 0; row < slabs_.rows(); ++row) {
        const std::ptrdiff_t x = row / slabs_.ny(), y = row % slabs_.ny();
        const auto values = [&](Field f) { return state(f).total.data() + row * slabs_.pitch; };
        const Real *xx = values(Field::sxx), *yy = values(Field::syy), *zz = values(Field::szz);
        const Real *dt_lambda = coefficients_->dt_lambda.row(x, y),
                   *dt_modulus = coefficients_->dt_p_modulus.row(x, y);
        for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z) {
            const double lambda = static_cast<double>(dt_lambda[z]),
                         twice_mu = static_cast<double>(dt_modulus[z]) - lambda;
            if (dt_modulus[z] <= Real(0)) continue; // empty
            const double trace = static_cast<double>(xx[z] + yy[z] + zz[z]);
            // The difference of the two moduli of a fluid is a rounding error.
            if (twice_mu <= 1e-6 * lambda) {
                sum += trace * trace / (9.0 * lambda);
                continue;
            }
            sum += static_cast<double>(xx[z] * xx[z] + yy[z] * yy[z] + zz[z] * zz[z]) / twice_mu;
            // A negative bulk modulus leaves an upper bound.
            if (const double bulk_3 = 3.0 * lambda + twice_mu; bulk_3 > 0.0)
                sum -= lambda / bulk_3 * trace * trace / twice_mu;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const Real* s = values(static_cast<Field>(index_of(Field::sxy) + i));
            const Real* dt_mu = coefficients_->dt_mu[i].row(x, y);
            for (std::ptrdiff_t z = 0; z < slabs_.nz(); ++z)
                if (dt_mu[z] > Real(0)) sum += static_cast<double>(s[z] * s[z] / dt_mu[z]);
        }
    }
    return 0.5 * volume_m3() * slabs_.grid.dt_s * sum;
}

template <class Real>
double Stepper<Real>::work_J() const {
    double sum = 0.0;
    for (const PlacedSource<Real>& source : sources_)
        sum += source.work_J();
    return sum;
}

template double Stepper<double>::kinetic_J() const;
template double Stepper<double>::elastic_J() const;
template double Stepper<double>::work_J() const;
template double Stepper<float>::kinetic_J() const;
template double Stepper<float>::elastic_J() const;
template double Stepper<float>::work_J() const;

} // namespace shearwake::pstd
