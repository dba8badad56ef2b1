// SPDX-License-Identifier: BSD-3-Clause
#include "studies/laboratory/least_squares.hpp"

#include "base/error.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <memory>
#if SHEARWAKE_CERES
#include <ceres/ceres.h>
#endif

namespace shearwake::laboratory {
namespace {

/// Residuals of a point above this multiple of the typical ones reduce its weight.
constexpr double outlier_scale = 2.0;
#if SHEARWAKE_CERES

/// Relative step of the derivatives: truncation and the interpolation of the engine both
/// contribute about 1e-3.
constexpr double relative_step = 1e-3;
constexpr int most_rounds = 4, most_iterations = 30; // rounds: of the noise

using Matrix = Eigen::MatrixXd;
using Vector = Eigen::VectorXd;

/// The model and its derivatives at the last values, shared by the residuals of all points.
class Evaluations : public ceres::EvaluationCallback {
public:
    Evaluations(const std::vector<Parameter>& parameters, const Model& model)
        : parameters_(parameters), model_(model) {
        for (const Parameter& parameter : parameters) {
            scales_.push_back(
                std::max(std::abs(parameter.start), 1e-3 * (parameter.high - parameter.low)));
            scaled_.push_back(parameter.start / scales_.back());
        }
    }

    void PrepareForEvaluation(bool with_derivatives, bool /*at_new_values*/) override {
        if (!values_ || scaled_ != evaluated_at_) {
            values_ = model_(unscaled());
            evaluated_at_ = scaled_;
            has_derivatives_ = false;
        }
        if (with_derivatives && values_ && !has_derivatives_) differentiate();
    }

    double* scaled() { return scaled_.data(); }
    std::size_t count() const { return scaled_.size(); }
    double scale(std::size_t i) const { return scales_[i]; }
    double value(std::size_t i) const { return scaled_[i] * scales_[i]; }
    std::vector<double> unscaled() const {
        std::vector<double> all;
        for (std::size_t i = 0; i < count(); ++i)
            all.push_back(value(i));
        return all;
    }
    const std::optional<std::vector<double>>& values() const { return values_; }
    bool has_derivatives() const { return has_derivatives_; }
    /// By the scaled parameter.
    const std::vector<double>& derivative(std::size_t i) const { return derivatives_[i]; }

private:
    void differentiate() {
        derivatives_.assign(count(), {});
        for (std::size_t i = 0; i < count(); ++i) {
            std::vector<double> at = unscaled();
            const Parameter& parameter = parameters_[i];
            double step =
                relative_step * std::max(std::abs(at[i]), 0.01 * (parameter.high - parameter.low));
            if (at[i] + step > parameter.high) step = -step;
            at[i] += step;
            const auto moved = model_(at);
            if (!moved) return;
            std::vector<double>& column = derivatives_[i];
            column.resize(values_->size());
            for (std::size_t n = 0; n < column.size(); ++n)
                column[n] = ((*moved)[n] - (*values_)[n]) / (step / scales_[i]);
        }
        has_derivatives_ = true;
    }

    const std::vector<Parameter>& parameters_;
    const Model& model_;
    std::vector<double> scales_, scaled_, evaluated_at_;
    std::optional<std::vector<double>> values_;
    std::vector<std::vector<double>> derivatives_;
    bool has_derivatives_ = false;
};

/// The residuals of one point divided by the noise and the root of the number of samples, so that
/// the sum of their squares is 1 for a typical point.
class PointResiduals : public ceres::CostFunction {
public:
    PointResiduals(const Evaluations& evaluations, std::span<const double> observed,
                   std::size_t first, std::size_t samples, const double& noise)
        : evaluations_(evaluations), observed_(observed), first_(first), samples_(samples),
          noise_(noise) {
        mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluations.count()));
        set_num_residuals(static_cast<int>(samples));
    }

    bool Evaluate(double const* const*, double* residuals, double** jacobians) const override {
        const auto& values = evaluations_.values();
        const bool differentiates = jacobians && jacobians[0];
        if (!values || (differentiates && !evaluations_.has_derivatives())) return false;
        const double scale = 1.0 / (noise_ * std::sqrt(static_cast<double>(samples_)));
        const std::size_t count = evaluations_.count();
        for (std::size_t n = 0; n < samples_; ++n) {
            residuals[n] = scale * ((*values)[first_ + n] - observed_[first_ + n]);
            for (std::size_t i = 0; differentiates && i < count; ++i)
                jacobians[0][n * count + i] = scale * evaluations_.derivative(i)[first_ + n];
        }
        return true;
    }

private:
    const Evaluations& evaluations_;
    std::span<const double> observed_;
    std::size_t first_, samples_;
    const double& noise_;
};

class PriorResiduals : public ceres::CostFunction {
public:
    PriorResiduals(const std::vector<Parameter>& parameters, const Evaluations& evaluations)
        : evaluations_(evaluations) {
        for (std::size_t i = 0; i < parameters.size(); ++i)
            if (parameters[i].prior) priors_.push_back({i, *parameters[i].prior});
        mutable_parameter_block_sizes()->push_back(static_cast<int>(evaluations.count()));
        set_num_residuals(static_cast<int>(priors_.size()));
    }
    bool exists() const { return !priors_.empty(); }

    bool Evaluate(double const* const* scaled, double* residuals,
                  double** jacobians) const override {
        const std::size_t count = evaluations_.count();
        if (jacobians && jacobians[0]) std::fill_n(jacobians[0], priors_.size() * count, 0.0);
        for (std::size_t row = 0; row < priors_.size(); ++row) {
            const auto& [i, prior] = priors_[row];
            const double value = scaled[0][i] * evaluations_.scale(i);
            if (prior.logarithmic && value <= 0.0) return false;
            residuals[row] =
                ((prior.logarithmic ? std::log(value) : value) - prior.mean) / prior.sd;
            if (jacobians && jacobians[0])
                jacobians[0][row * count + i] =
                    (prior.logarithmic ? 1.0 / value : 1.0) * evaluations_.scale(i) / prior.sd;
        }
        return true;
    }

private:
    struct Indexed {
        std::size_t parameter;
        Prior prior;
    };
    const Evaluations& evaluations_;
    std::vector<Indexed> priors_;
};

class Fit {
public:
    Fit(const std::vector<Parameter>& parameters, std::span<const double> observed,
        std::size_t points, const Model& model)
        : parameters_(parameters), observed_(observed), points_(points),
          samples_(observed.size() / points), evaluations_(parameters, model),
          priors_(parameters, evaluations_) {}

    FitResult run(std::optional<double> known_noise) {
        evaluations_.PrepareForEvaluation(true, true);
        if (!evaluations_.values() || !evaluations_.has_derivatives())
            throw UsageError("the case cannot be computed with the start values of the fit");
        must_depend();
        FitResult result;
        noise_ = known_noise.value_or(typical_residual());
        for (int round = 0; round < most_rounds; ++round) {
            solve(result);
            if (known_noise) break;
            const double before = noise_;
            noise_ = typical_residual();
            if (std::abs(noise_ - before) < 0.01 * before) break;
        }
        evaluations_.PrepareForEvaluation(true, true);
        if (!evaluations_.values() || !evaluations_.has_derivatives())
            throw UsageError("the case cannot be computed with the estimates of the fit");
        describe(result);
        return result;
    }

private:
    void must_depend() const {
        for (std::size_t i = 0; i < parameters_.size(); ++i)
            if (std::ranges::all_of(evaluations_.derivative(i), [](double d) { return d == 0.0; }))
                throw UsageError("the motion at the points of the scan does not depend on " +
                                 parameters_[i].key + ": remove it from [uncertain]");
    }

    double mean_square(std::size_t point) const {
        double sum = 0.0;
        for (std::size_t n = point * samples_; n < (point + 1) * samples_; ++n) {
            const double residual = (*evaluations_.values())[n] - observed_[n];
            sum += residual * residual;
        }
        return sum / static_cast<double>(samples_);
    }

    double typical_residual() const {
        std::vector<double> squares;
        double data = 0.0;
        for (std::size_t point = 0; point < points_; ++point)
            squares.push_back(mean_square(point));
        for (const double value : observed_)
            data += value * value;
        const auto middle = squares.begin() + static_cast<std::ptrdiff_t>(points_ / 2);
        std::nth_element(squares.begin(), middle, squares.end());
        // Data without noise must not be divided by zero.
        const double least = 1e-8 * std::sqrt(data / static_cast<double>(observed_.size()));
        return std::max({std::sqrt(*middle), least, 1e-30});
    }

    void solve(FitResult& result) {
        ceres::Problem::Options owned;
        owned.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        owned.loss_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
        owned.evaluation_callback = &evaluations_;
        ceres::Problem problem(owned);
        double* const scaled = evaluations_.scaled();
        std::vector<std::unique_ptr<PointResiduals>> residuals;
        ceres::CauchyLoss cauchy(outlier_scale);
        ceres::ScaledLoss loss(&cauchy, static_cast<double>(samples_),
                               ceres::DO_NOT_TAKE_OWNERSHIP);
        for (std::size_t point = 0; point < points_; ++point) {
            residuals.push_back(std::make_unique<PointResiduals>(
                evaluations_, observed_, point * samples_, samples_, noise_));
            problem.AddResidualBlock(residuals.back().get(), &loss, scaled);
        }
        if (priors_.exists()) problem.AddResidualBlock(&priors_, nullptr, scaled);
        for (std::size_t i = 0; i < parameters_.size(); ++i) {
            const int index = static_cast<int>(i);
            const double scale = evaluations_.scale(i);
            problem.SetParameterLowerBound(scaled, index, parameters_[i].low / scale);
            problem.SetParameterUpperBound(scaled, index, parameters_[i].high / scale);
        }
        ceres::Solver::Options options;
        options.linear_solver_type = ceres::DENSE_QR;
        options.max_num_iterations = most_iterations;
        options.function_tolerance = 1e-6; // far less than one unit of chi squared
        options.parameter_tolerance = 1e-6;
        options.logging_type = ceres::SILENT;
        options.num_threads = 1;
        ceres::Solver::Summary summary;
        ceres::Solve(options, &problem, &summary);
        result.has_converged = summary.termination_type == ceres::CONVERGENCE;
        result.report = summary.BriefReport();
        // The last evaluation may belong to a rejected step.
        evaluations_.PrepareForEvaluation(true, true);
        if (!evaluations_.values())
            throw UsageError("the case cannot be computed: " + summary.message);
    }

    double weight(std::size_t point) const {
        const double ratio = mean_square(point) / (noise_ * noise_);
        return 1.0 / (1.0 + ratio / (outlier_scale * outlier_scale));
    }

    /// The contributions of the points to the information matrix, and their scores, for the scaled
    /// parameters.
    struct Information {
        Matrix matrix;
        Vector score;
    };
    Eigen::Index count() const { return static_cast<Eigen::Index>(parameters_.size()); }

    std::vector<Information> information() const {
        const auto rows = static_cast<Eigen::Index>(samples_);
        std::vector<Information> all;
        for (std::size_t point = 0; point < points_; ++point) {
            Matrix jacobian(rows, count());
            Vector residual(rows);
            for (Eigen::Index n = 0; n < rows; ++n) {
                const std::size_t at = point * samples_ + static_cast<std::size_t>(n);
                residual[n] = (observed_[at] - (*evaluations_.values())[at]) / noise_;
                for (Eigen::Index i = 0; i < count(); ++i)
                    jacobian(n, i) =
                        evaluations_.derivative(static_cast<std::size_t>(i))[at] / noise_;
            }
            all.push_back({weight(point) * jacobian.transpose() * jacobian,
                           weight(point) * jacobian.transpose() * residual});
        }
        return all;
    }

    Matrix prior_information() const {
        Matrix sum = Matrix::Zero(count(), count());
        for (std::size_t i = 0; i < parameters_.size(); ++i) {
            if (!parameters_[i].prior) continue;
            const Prior& prior = *parameters_[i].prior;
            const double slope = (prior.logarithmic ? 1.0 / evaluations_.value(i) : 1.0) *
                                 evaluations_.scale(i) / prior.sd;
            const auto at = static_cast<Eigen::Index>(i);
            sum(at, at) = slope * slope;
        }
        return sum;
    }

    /// The covariance of the scaled parameters and the degrees of freedom of each variance. The
    /// score of a point is divided by the share that the fit has left of it, I - B A^-1 with the
    /// information B of the point and A of all ("CR3"; R. M. Bell and D. F. McCaffrey, Survey
    /// Methodology 28, 169, 2002). The degrees of freedom are those of Satterthwaite's
    /// approximation: few, if few points determine a parameter.
    std::pair<Matrix, Vector> covariance() const {
        const std::vector<Information> points = information();
        const Matrix prior = prior_information();
        Matrix all = prior;
        for (const Information& one : points)
            all += one.matrix;
        const Matrix inverse = all.completeOrthogonalDecomposition().pseudoInverse();
        if (points_ <= parameters_.size() + 1)
            return {inverse, Vector::Constant(count(), static_cast<double>(points_ * samples_) -
                                                           static_cast<double>(count()))};
        Matrix scores = prior;
        Vector variances = (inverse * prior * inverse).diagonal(),
               squares = Vector::Zero(count()); // of independent residuals
        for (const Information& one : points) {
            const Matrix left = Matrix::Identity(count(), count()) - one.matrix * inverse;
            const Vector score = left.fullPivLu().solve(one.score);
            scores += score * score.transpose();
            const Vector variance = (inverse * one.matrix * inverse).diagonal();
            variances += variance;
            squares += variance.cwiseAbs2();
        }
        return {inverse * scores * inverse,
                variances.cwiseAbs2().cwiseQuotient(squares.cwiseMax(1e-300))};
    }

    void describe(FitResult& result) const {
        const auto [covariances, degrees] = covariance();
        for (std::size_t i = 0; i < parameters_.size(); ++i) {
            const auto at = static_cast<Eigen::Index>(i);
            const double value = evaluations_.value(i),
                         error = std::sqrt(covariances(at, at)) * evaluations_.scale(i),
                         half = half_width_95(std::clamp(degrees[at], 1.0, 1e9)),
                         range = parameters_[i].high - parameters_[i].low;
            result.estimates.push_back(
                {value, error, value - half * error, value + half * error,
                 std::min(value - parameters_[i].low, parameters_[i].high - value) < 1e-6 * range});
        }
        result.correlations.clear();
        for (Eigen::Index i = 0; i < count(); ++i)
            for (Eigen::Index j = 0; j < count(); ++j)
                result.correlations.push_back(covariances(i, j) /
                                              std::sqrt(covariances(i, i) * covariances(j, j)));
        for (std::size_t point = 0; point < points_; ++point) {
            result.residual_rms.push_back(std::sqrt(mean_square(point)));
            result.weights.push_back(weight(point));
            result.chi_squared += robust_chi_squared(mean_square(point), samples_, noise_);
        }
        result.noise = noise_;
        result.predicted = *evaluations_.values();
    }

    const std::vector<Parameter>& parameters_;
    std::span<const double> observed_;
    std::size_t points_, samples_;
    Evaluations evaluations_;
    PriorResiduals priors_;
    double noise_ = 1.0;
};
#endif

} // namespace

const bool can_fit = SHEARWAKE_CERES;

double robust_chi_squared(double mean_square, std::size_t samples, double noise) {
    const double allowed = outlier_scale * outlier_scale;
    return static_cast<double>(samples) * allowed *
           std::log1p(mean_square / (noise * noise * allowed));
}

#if SHEARWAKE_CERES
FitResult fit(const std::vector<Parameter>& parameters, std::span<const double> observed,
              std::size_t points, const Model& model, std::optional<double> noise) {
    return Fit(parameters, observed, points, model).run(noise);
}
#else
FitResult fit(const std::vector<Parameter>&, std::span<const double>, std::size_t, const Model&,
              std::optional<double>) {
    throw Error("built without Ceres Solver");
}
#endif

double half_width_95(double degrees) {
    return boost::math::quantile(boost::math::students_t(degrees), 0.975);
}

} // namespace shearwake::laboratory
