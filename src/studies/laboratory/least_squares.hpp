// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace shearwake::laboratory {

/// The factor between the standard error and half of the 95 % confidence interval: the quantile
/// 0.975 of Student's t distribution. `degrees` >= 1.
double half_width_95(double degrees);

/// A normal prior of a number or of its logarithm.
struct Prior {
    double mean = 0.0, sd = 1.0; // of the logarithm if `logarithmic`
    bool logarithmic = false;
};

/// A number to be estimated, in the unit of its key.
struct Parameter {
    std::string key;
    double start = 0.0, low = 0.0, high = 1.0;
    std::optional<Prior> prior = std::nullopt;
};

/// The velocities of a model at all points and samples, one row per point; nothing if it cannot be
/// computed for these values.
using Model = std::function<std::optional<std::vector<double>>(std::span<const double>)>;

struct Estimate {
    double value = 0.0, standard_error = 0.0;
    double low_95 = 0.0, high_95 = 0.0; // confidence interval
    bool is_at_bound = false;
};

struct FitResult {
    std::vector<Estimate> estimates;
    std::vector<double> correlations; // square matrix, row by row
    std::vector<double> residual_rms; // of each point, unit of the data
    std::vector<double> weights;      // of each point, 0 to 1: below 0.5 it is an outlier
    std::vector<double> predicted;    // by the model at the estimates
    double noise = 0.0;               // typical residual of a sample
    double chi_squared = 0.0;         // sum of the weighted squares in units of the noise
    bool has_converged = false;
    std::string report; // of the solver
};

/// The contribution of a point with this mean square of its residuals to chi_squared.
double robust_chi_squared(double mean_square, std::size_t samples, double noise);

/// Estimates the parameters by nonlinear least squares (Ceres, trust region with bounds). A point
/// whose residuals are large as a whole is an outlier, whose weight is reduced (Cauchy's loss). The
/// noise is the median of the residuals of the points. The standard errors are those of a
/// heteroscedastic model in which points are independent of each other and samples of a point are
/// not ("cluster-robust"), so that coloured noise and filters do not make them too small; a
/// parameter that few points determine has few degrees of freedom and a wide interval. With at most
/// one more point than parameters they follow from the noise alone. Throws UsageError if the
/// model cannot be computed at the start or depends on no parameter. `noise`: that of a sample, if
/// it is known, as in the comparison of two models. Not collective.
FitResult fit(const std::vector<Parameter>& parameters, std::span<const double> observed,
              std::size_t points, const Model& model, std::optional<double> noise = std::nullopt);

/// False if the program was built without Ceres Solver; fit() then throws.
extern const bool can_fit;

} // namespace shearwake::laboratory
