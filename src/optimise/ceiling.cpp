// SPDX-License-Identifier: BSD-3-Clause
#include "optimise/ceiling.hpp"

#include <cmath>
#include <optional>

namespace shearwake::optimise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double relative_accuracy = 1e-4; // of eta

/// Minimises sum w over w, mu >= 0 with diag(w) - F - mu G positive semidefinite, until the sum is
/// less than `target` or a lower bound of the minimum is not.
class BarrierSolver {
public:
    BarrierSolver(const MatrixXd& focal, const MatrixXd& gain) : focal_(focal), gain_(gain) {
        mu_ = 1.0;
        weights_ = (focal_ + mu_ * gain_).cwiseAbs().rowwise().sum();
        weights_.array() += 1.0 / static_cast<double>(weights_.size());
    }

    bool reaches(double target) {
        const double terms = static_cast<double>(2 * weights_.size() + 1);
        for (double sharpness = 10.0; sharpness < 1e9; sharpness *= 4.0) {
            for (int n = 0; n < most_steps; ++n) {
                const double decrement = newton_step(sharpness);
                if (weights_.sum() < target) return true;
                if (decrement < 1e-3) break;
            }
            // At the centre the duality gap is terms / sharpness; twice that, since it is reached
            // approximately.
            if (weights_.sum() - 2.0 * terms / sharpness > target) return false;
        }
        return false;
    }

    const VectorXd& weights() const { return weights_; }
    double mu() const { return mu_; }

private:
    static constexpr int most_steps = 50;

    /// The sum of the barriers; none outside of the constraints.
    std::optional<double> barrier(const VectorXd& weights, double mu, double sharpness) const {
        if (!(weights.minCoeff() > 0.0) || !(mu > 0.0)) return std::nullopt;
        const Eigen::LLT<MatrixXd> factor(slack(weights, mu));
        if (factor.info() != Eigen::Success) return std::nullopt;
        const VectorXd diagonal = factor.matrixLLT().diagonal();
        return sharpness * weights.sum() - 2.0 * diagonal.array().log().sum() -
               weights.array().log().sum() - std::log(mu);
    }

    MatrixXd slack(const VectorXd& weights, double mu) const {
        MatrixXd s = -focal_ - mu * gain_;
        s.diagonal() += weights;
        return s;
    }

    /// Returns the square of the Newton decrement before the step.
    double newton_step(double sharpness) {
        const Eigen::Index n = weights_.size();
        const MatrixXd inverse =
            Eigen::LLT<MatrixXd>(slack(weights_, mu_)).solve(MatrixXd::Identity(n, n));
        const MatrixXd product = inverse * gain_;
        VectorXd gradient(n + 1);
        gradient.head(n) =
            (sharpness - inverse.diagonal().array() - weights_.array().inverse()).matrix();
        gradient(n) = product.trace() - 1.0 / mu_;
        MatrixXd hessian(n + 1, n + 1);
        hessian.topLeftCorner(n, n) = inverse.cwiseProduct(inverse);
        hessian.topLeftCorner(n, n).diagonal().array() += weights_.array().square().inverse();
        hessian.col(n).head(n) = -(product * inverse).diagonal();
        hessian.row(n).head(n) = hessian.col(n).head(n).transpose();
        hessian(n, n) = product.cwiseProduct(product.transpose()).sum() + 1.0 / (mu_ * mu_);
        const VectorXd step = -hessian.ldlt().solve(gradient);
        const double slope = gradient.dot(step);
        if (!(slope < 0.0)) return 0.0;
        const double before = barrier(weights_, mu_, sharpness).value();
        for (double length = 1.0; length > 1e-12; length *= 0.5) {
            const VectorXd weights = weights_ + length * step.head(n);
            const double mu = mu_ + length * step(n);
            const auto after = barrier(weights, mu, sharpness);
            if (!after || *after > before + 0.1 * length * slope) continue;
            weights_ = weights;
            mu_ = mu;
            return -slope;
        }
        return 0.0;
    }

    MatrixXd focal_, gain_;
    VectorXd weights_;
    double mu_ = 1.0;
};

/// The largest eta of any envelope, also with negative values and any strength.
double greatest_eta(const Forms& forms) {
    const double scale = forms.denominator.trace() / static_cast<double>(forms.knots());
    MatrixXd denominator = forms.denominator / scale;
    denominator.diagonal().array() += 1e-12; // rounding may have made an eigenvalue negative
    const Eigen::GeneralizedSelfAdjointEigenSolver<MatrixXd> solver(
        forms.numerator / scale, denominator, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().maxCoeff();
}

} // namespace

bool is_valid(const Forms& forms, const Certificate& c, double rounding) {
    if (!(c.mu >= 0.0) || !(c.weights.minCoeff() >= 0.0)) return false;
    MatrixXd slack = -forms.focal - c.mu * (forms.numerator - c.eta * forms.denominator);
    slack.diagonal() += c.weights;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(slack, Eigen::EigenvaluesOnly);
    return solver.eigenvalues().minCoeff() >= -rounding * forms.focal.trace() &&
           c.weights.sum() < c.strength * c.strength * forms.reference_energy();
}

Certificate ceiling(const Forms& forms, double strength) {
    // Units in which the reference has a focal energy, and the unmodulated load a total energy,
    // of 1.
    const double focal_unit = forms.reference_energy(), unit = forms.denominator.sum();
    const MatrixXd focal = forms.focal / focal_unit;
    Certificate best{.strength = strength, .weights = {}};
    double reached = eta(forms, VectorXd::Ones(forms.knots())); // by the unmodulated load
    double excluded = 1.001 * greatest_eta(forms) + 1e-9;
    const auto attempt = [&](double limit) {
        BarrierSolver solver(focal, (forms.numerator - limit * forms.denominator) / unit);
        // A margin for rounding, far below the accuracy of eta.
        if (!solver.reaches(strength * strength * (1.0 - 1e-9))) return false;
        best.eta = limit;
        best.mu = solver.mu() * focal_unit / unit;
        best.weights = solver.weights() * focal_unit;
        return true;
    };
    while (!attempt(excluded))
        excluded *= 1.1; // the eigenvalue was in error by rounding
    while (excluded - reached > relative_accuracy * excluded) {
        const double middle = 0.5 * (reached + excluded);
        (attempt(middle) ? excluded : reached) = middle;
    }
    return best;
}

} // namespace shearwake::optimise
