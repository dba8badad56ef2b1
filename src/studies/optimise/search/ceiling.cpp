// SPDX-License-Identifier: BSD-3-Clause
#include "studies/optimise/search/search.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace shearwake::optimise {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

constexpr double relative_accuracy = 1e-4; // of eta

/// The matrix of a certificate for the form M = F + mu (N - eta D).
MatrixXd certificate_matrix(const MatrixXd& form, double tau, const VectorXd& weights) {
    const Eigen::Index n = weights.size();
    MatrixXd matrix(n + 1, n + 1);
    matrix(0, 0) = tau;
    matrix.col(0).tail(n) = -0.5 * weights;
    matrix.row(0).tail(n) = -0.5 * weights.transpose();
    matrix.bottomRightCorner(n, n) = -form;
    matrix.diagonal().tail(n) += weights;
    return matrix;
}

MatrixXd certificate_matrix(const Forms& forms, const Certificate& c) {
    return certificate_matrix(forms.focal + c.mu * (forms.numerator - c.eta * forms.denominator),
                              c.tau, c.weights);
}

/// Minimises tau over tau, w >= 0 and mu >= 0 with the matrix of a certificate positive
/// semidefinite, until tau is less than `target` or a lower bound of the minimum is not.
class BarrierSolver {
public:
    BarrierSolver(const MatrixXd& focal, const MatrixXd& gain) : focal_(focal), gain_(gain) {
        const VectorXd rows = (focal_ + gain_).cwiseAbs().rowwise().sum();
        const double margin = 1.0 / static_cast<double>(rows.size());
        // With 2 w the matrix is diagonally dominant if tau is at least the sum of w.
        weights_ = 2.0 * rows + VectorXd::Constant(rows.size(), 2.0 * margin);
        tau_ = weights_.sum();
    }

    bool reaches(double target) {
        const double terms = static_cast<double>(2 * weights_.size() + 2);
        for (double sharpness = 10.0; sharpness < 1e9; sharpness *= 4.0) {
            for (int n = 0; n < most_steps; ++n) {
                const double decrement = newton_step(sharpness);
                if (tau_ < target) return true;
                if (decrement < 1e-3) break;
            }
            // At the centre the duality gap is terms / sharpness; twice that, since it is reached
            // approximately.
            if (tau_ - 2.0 * terms / sharpness > target) return false;
        }
        return false;
    }

    const VectorXd& weights() const { return weights_; }
    double mu() const { return mu_; }
    double tau() const { return tau_; }

private:
    static constexpr int most_steps = 50;

    /// The sum of the barriers; none outside of the constraints.
    std::optional<double> barrier(double tau, const VectorXd& weights, double mu,
                                  double sharpness) const {
        if (!(weights.minCoeff() > 0.0) || !(mu > 0.0)) return std::nullopt;
        const Eigen::LLT<MatrixXd> factor(slack(tau, weights, mu));
        if (factor.info() != Eigen::Success) return std::nullopt;
        const VectorXd diagonal = factor.matrixLLT().diagonal();
        return sharpness * tau - 2.0 * diagonal.array().log().sum() - weights.array().log().sum() -
               std::log(mu);
    }

    MatrixXd slack(double tau, const VectorXd& weights, double mu) const {
        return certificate_matrix(focal_ + mu * gain_, tau, weights);
    }

    /// Gradient and Hessian of the barriers with respect to tau, w and mu. The matrix depends on
    /// w_i by (a b' + b a') / 2 with the unit vector a = i and b = i - 0.
    void derive(double sharpness, VectorXd& gradient, MatrixXd& hessian) const {
        const Eigen::Index n = weights_.size();
        const MatrixXd inverse = Eigen::LLT<MatrixXd>(slack(tau_, weights_, mu_))
                                     .solve(MatrixXd::Identity(n + 1, n + 1));
        const double corner = inverse(0, 0);
        const VectorXd edge = inverse.col(0).tail(n);
        const MatrixXd aa = inverse.bottomRightCorner(n, n);
        const MatrixXd ab = aa.colwise() - edge; // row i, column j: a_i' inverse b_j
        MatrixXd bb = ab.rowwise() - edge.transpose();
        bb.array() += corner;
        const MatrixXd product = aa * gain_;
        const VectorXd gain_edge = gain_ * edge;
        gradient.resize(n + 2);
        gradient(0) = sharpness - corner;
        gradient.segment(1, n) = -(ab.diagonal() + weights_.cwiseInverse());
        gradient(n + 1) = product.trace() - 1.0 / mu_;
        hessian.resize(n + 2, n + 2);
        hessian(0, 0) = corner * corner;
        hessian.col(0).segment(1, n) = edge.cwiseAbs2() - corner * edge;
        hessian(n + 1, 0) = -edge.dot(gain_edge);
        hessian.block(1, 1, n, n) = 0.5 * (aa.cwiseProduct(bb) + ab.cwiseProduct(ab.transpose()));
        hessian.block(1, 1, n, n).diagonal().array() += weights_.array().square().inverse();
        hessian.row(n + 1).segment(1, n) = (aa * gain_edge - (product * aa).diagonal()).transpose();
        hessian(n + 1, n + 1) = product.cwiseProduct(product.transpose()).sum() + 1.0 / (mu_ * mu_);
        hessian = hessian.selfadjointView<Eigen::Lower>().toDenseMatrix();
    }

    /// Returns the square of the Newton decrement before the step.
    double newton_step(double sharpness) {
        const Eigen::Index n = weights_.size();
        VectorXd gradient;
        MatrixXd hessian;
        derive(sharpness, gradient, hessian);
        const VectorXd step = -hessian.ldlt().solve(gradient);
        const double slope = gradient.dot(step);
        if (!(slope < 0.0)) return 0.0;
        const double before = barrier(tau_, weights_, mu_, sharpness).value();
        for (double length = 1.0; length > 1e-12; length *= 0.5) {
            const double tau = tau_ + length * step(0);
            const VectorXd weights = weights_ + length * step.segment(1, n);
            const double mu = mu_ + length * step(n + 1);
            const auto after = barrier(tau, weights, mu, sharpness);
            if (!after || *after > before + 0.1 * length * slope) continue;
            tau_ = tau;
            weights_ = weights;
            mu_ = mu;
            return -slope;
        }
        return 0.0;
    }

    MatrixXd focal_, gain_;
    VectorXd weights_;
    double mu_ = 1.0, tau_ = 0.0;
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

bool is_valid(const Forms& forms, const Certificate& c) {
    if (!(c.mu >= 0.0) || !(c.weights.minCoeff() >= 0.0)) return false;
    const Eigen::SelfAdjointEigenSolver<MatrixXd> solver(certificate_matrix(forms, c),
                                                         Eigen::EigenvaluesOnly);
    const double deficit = std::max(0.0, -solver.eigenvalues().minCoeff());
    return c.tau + deficit * static_cast<double>(1 + forms.knots()) <
           c.strength * c.strength * forms.reference_energy();
}

VectorXd relaxed_envelope(const Forms& forms, const Certificate& c) {
    const double unit = c.tau; // of the matrix, for the decomposition
    const VectorXd first =
        (certificate_matrix(forms, c) / unit).ldlt().solve(VectorXd::Unit(1 + forms.knots(), 0));
    return (first.tail(forms.knots()) / first(0)).cwiseMax(0.0).cwiseMin(1.0);
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
        best.tau = solver.tau() * focal_unit;
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
