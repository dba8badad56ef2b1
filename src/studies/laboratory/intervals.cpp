// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/intervals.hpp"

#include <boost/math/distributions/students_t.hpp>

namespace shearwake::laboratory {

double half_width_95(double degrees) {
    return boost::math::quantile(boost::math::students_t(degrees), 0.975);
}

} // namespace shearwake::laboratory
