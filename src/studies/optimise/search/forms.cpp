// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/forms.hpp"

namespace shearwake::optimise {

double eta(const Forms& forms, const Eigen::VectorXd& envelope) {
    return envelope.dot(forms.numerator * envelope) / envelope.dot(forms.denominator * envelope);
}

Eigen::VectorXd eta_gradient(const Forms& forms, const Eigen::VectorXd& envelope) {
    const Eigen::VectorXd n = forms.numerator * envelope, d = forms.denominator * envelope;
    const double below = envelope.dot(d);
    return 2.0 / below * (n - envelope.dot(n) / below * d);
}

double squared_strength(const Forms& forms, const Eigen::VectorXd& envelope) {
    return envelope.dot(forms.focal * envelope) / forms.reference_energy();
}

Eigen::VectorXd squared_strength_gradient(const Forms& forms, const Eigen::VectorXd& envelope) {
    return 2.0 / forms.reference_energy() * (forms.focal * envelope);
}

} // namespace shearwake::optimise
