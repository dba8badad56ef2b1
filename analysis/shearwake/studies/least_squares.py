# SPDX-License-Identifier: BSD-3-Clause
"""Nonlinear least squares for recordings at many points, some of which are outliers, with bounds, priors and confidence intervals."""
from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares
from scipy.stats import t as student

from ..errors import UsageError

Values = Sequence[float] | np.ndarray
Model = Callable[[Values], "np.ndarray | None"]  # velocities (point, sample); None: the case cannot be computed

OUTLIER_SCALE = 2.0  # residuals of a point above this multiple of the typical ones reduce its weight
OUTLIER_WEIGHT = 0.5  # a point below this weight is an outlier
RELATIVE_STEP = 1e-3  # of derivatives: truncation and the interpolation of the engine both contribute about 1e-3
MOST_ROUNDS, MOST_ITERATIONS = 4, 30  # rounds: of the noise
TOLERANCE = 1e-8  # relative; less than a hundredth of a unit of chi squared with a million samples


@dataclass(frozen=True)
class Prior:
    """A normal prior of a number or of its logarithm, to which mean and standard deviation refer then."""

    mean: float
    sd: float
    logarithmic: bool = False


@dataclass(frozen=True)
class Parameter:
    """A number to be estimated, in the unit of its key."""

    key: str
    start: float
    low: float
    high: float
    prior: Prior | None = None


@dataclass(frozen=True)
class Estimate:
    """The value of a parameter with its standard error and 95 % confidence interval."""

    value: float
    standard_error: float
    low_95: float
    high_95: float
    is_at_bound: bool


@dataclass(frozen=True)
class FitResult:
    """`residual_rms` and `weights` (0 to 1) belong to points, `predicted` has the shape of the data, `noise` is the typical residual of a
    sample, and `chi_squared` the sum of the weighted squares in units of the noise."""

    estimates: list[Estimate]
    correlations: np.ndarray
    residual_rms: np.ndarray
    weights: np.ndarray
    predicted: np.ndarray
    noise: float
    chi_squared: float
    has_converged: bool
    report: str

    @property
    def outliers(self) -> int:
        """The number of points that are outliers."""
        return int(np.count_nonzero(self.weights < OUTLIER_WEIGHT))


def weights_of(mean_square: np.ndarray, noise: float) -> np.ndarray:
    """The weight of each point by Cauchy's loss."""
    return 1.0 / (1.0 + mean_square / (noise * OUTLIER_SCALE) ** 2)


def robust_chi_squared(mean_square: np.ndarray, samples: int, noise: float) -> float:
    """The sum of Cauchy's loss over points with these mean squares of their residuals."""
    return float(np.sum(samples * OUTLIER_SCALE**2 * np.log1p(mean_square / (noise * OUTLIER_SCALE) ** 2)))


class Evaluations:
    """The model and its derivatives by the scaled parameters, of which the last ones are kept."""

    def __init__(self, parameters: Sequence[Parameter], model: Model) -> None:
        self.parameters, self.model = parameters, model
        self.low, self.high, start = (np.array([getattr(p, name) for p in parameters]) for name in ("low", "high", "start"))
        priors = np.array([p.prior.sd if p.prior and not p.prior.logarithmic else 0.0 for p in parameters])
        self.scales = np.maximum.reduce([np.abs(start), 1e-3 * (self.high - self.low), priors])  # the first step is at most one of them
        self.start = start / self.scales
        self._last: tuple[bytes, np.ndarray | None] | None = None
        self._derivatives: tuple[bytes, np.ndarray] | None = None

    def velocities(self, scaled: np.ndarray) -> np.ndarray | None:
        if self._last is None or self._last[0] != scaled.tobytes():
            self._last = scaled.tobytes(), self.model(scaled * self.scales)
        return self._last[1]

    def derivatives(self, scaled: np.ndarray, reason: str) -> np.ndarray:
        """With the shape (point, sample, parameter). Raises UsageError if the case cannot be computed."""
        if self._derivatives is None or self._derivatives[0] != scaled.tobytes():
            values, columns = self.velocities(scaled), []
            place = scaled * self.scales
            steps = RELATIVE_STEP * np.maximum(np.abs(place), 0.01 * (self.high - self.low))
            steps = np.where(place + steps > self.high, -steps, steps)
            for i, step in enumerate(steps):
                moved = self.model(place + step * (np.arange(len(place)) == i)) if values is not None else None
                if values is None or moved is None:
                    raise UsageError(f"the case cannot be computed with the {reason} of the fit", 2)
                columns.append((moved - values) * (self.scales[i] / step))
            self._derivatives = scaled.tobytes(), np.stack(columns, axis=-1)
        return self._derivatives[1]

    def prior_residuals(self, scaled: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The residuals of the parameters that have a prior, and their derivatives by all scaled parameters."""
        values, residuals, slopes = scaled * self.scales, [], []
        for i, parameter in enumerate(self.parameters):
            if (prior := parameter.prior) is not None:
                place = np.log(values[i]) if prior.logarithmic and values[i] > 0.0 else np.inf if prior.logarithmic else values[i]
                residuals.append((place - prior.mean) / prior.sd)
                slopes.append(np.eye(len(values))[i] * self.scales[i] / prior.sd / (values[i] if prior.logarithmic else 1.0))
        return np.array(residuals), np.array(slopes).reshape(-1, len(values))


class Fit:
    """One fit, whose noise is `noise` or is estimated."""

    def __init__(self, parameters: Sequence[Parameter], observed: np.ndarray, model: Model) -> None:
        self.parameters, self.observed, self.noise = parameters, observed, 1.0
        self.points, self.samples = observed.shape
        self.evaluations = Evaluations(parameters, model)
        self.scaled = self.evaluations.start

    def run(self, noise: float | None) -> FitResult:
        slopes = self.evaluations.derivatives(self.scaled, "start values")
        for parameter, slope in zip(self.parameters, np.moveaxis(slopes, -1, 0)):
            if not np.any(slope):
                raise UsageError(f"the motion at the points of the scan does not depend on {parameter.key}: remove it from [uncertain]", 2)
        self.noise = self.typical_residual() if noise is None else noise
        for _ in range(MOST_ROUNDS):
            has_converged, report = self.solve()
            before = self.noise
            if noise is None:
                self.noise = self.typical_residual()
            if abs(self.noise - before) < 0.01 * before:
                break
        slopes = self.evaluations.derivatives(self.scaled, "estimates")
        covariance, degrees = self.covariance(slopes)
        errors = np.sqrt(np.diag(covariance))
        halves = student.ppf(0.975, np.clip(degrees, 1.0, 1e9)) * errors * self.evaluations.scales
        values, low, high = self.scaled * self.evaluations.scales, self.evaluations.low, self.evaluations.high
        estimates = [Estimate(float(value), float(error), float(value - half), float(value + half), bool(at_bound))
                     for value, error, half, at_bound in zip(values, errors * self.evaluations.scales, halves,
                                                             np.minimum(values - low, high - values) < 1e-6 * (high - low))]
        return FitResult(estimates, covariance / np.outer(errors, errors), np.sqrt(self.mean_square()),
                         weights_of(self.mean_square(), self.noise), self.observed - self.residuals(), self.noise,
                         robust_chi_squared(self.mean_square(), self.samples, self.noise), has_converged, report)

    def residuals(self) -> np.ndarray:
        velocities = self.evaluations.velocities(self.scaled)
        assert velocities is not None  # derivatives() and solve() need them
        return self.observed - velocities

    def mean_square(self) -> np.ndarray:
        """Of each point."""
        return np.mean(self.residuals() ** 2, axis=1)

    def typical_residual(self) -> float:
        """The median over the points. Data without noise must not be divided by zero."""
        median = np.sort(self.mean_square())[self.points // 2]
        return float(max(np.sqrt(median), 1e-8 * np.sqrt(np.mean(self.observed**2)), 1e-30))

    def solve(self) -> tuple[bool, str]:
        """Minimises the sum of Cauchy's loss over the points and of the squares of the priors."""
        size = self.observed.size

        def residuals(scaled: np.ndarray) -> np.ndarray:
            velocities, priors = self.evaluations.velocities(scaled), self.evaluations.prior_residuals(scaled)[0]
            point_residuals = np.full(size, np.inf) if velocities is None else (velocities - self.observed).ravel() / self.noise
            return np.concatenate((point_residuals, priors))

        def jacobian(scaled: np.ndarray) -> np.ndarray:
            slopes = self.evaluations.derivatives(scaled, "values") / self.noise
            return np.concatenate((slopes.reshape(size, -1), self.evaluations.prior_residuals(scaled)[1]))

        def loss(squares: np.ndarray) -> np.ndarray:
            """Of a point as a whole: its samples share the weight. The second derivative is left out, as in iterative reweighting."""
            means = np.mean(squares[:size].reshape(self.points, -1), axis=1)
            values = OUTLIER_SCALE**2 * np.log1p(means / OUTLIER_SCALE**2)
            rows = np.array([values, weights_of(means, 1.0), np.zeros(self.points)]).repeat(self.samples, axis=1)
            priors = squares[size:]
            return np.concatenate((rows, np.array([priors, np.ones_like(priors), np.zeros_like(priors)])), axis=1)

        low, high = self.evaluations.low / self.evaluations.scales, self.evaluations.high / self.evaluations.scales
        found = least_squares(residuals, np.clip(self.scaled, low, high), jacobian, (low, high), "dogbox", TOLERANCE, 1e-6, None,
                              loss=loss, max_nfev=MOST_ITERATIONS)
        self.scaled = found.x
        return found.status > 0, f"{found.message} {found.nfev} steps, cost {found.cost:.7g}"

    def covariance(self, slopes: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """The covariance of the scaled parameters and the degrees of freedom of each variance, for points that are independent of
        each other with samples that are not. The score of a point is divided by the share that the fit has left of it, I - B A^-1
        with the information B of the point and A of all ("CR3"; R. M. Bell and D. F. McCaffrey, Survey Methodology 28, 169, 2002).
        The degrees of freedom are those of Satterthwaite's approximation: few, if few points determine a parameter. With at most
        one more point than parameters the covariance follows from the noise alone."""
        count = len(self.parameters)
        slopes = slopes / self.noise
        weights = weights_of(self.mean_square(), self.noise)
        points = np.einsum("p,psi,psj->pij", weights, slopes, slopes)
        scores = np.einsum("p,psi,ps->pi", weights, slopes, self.residuals() / self.noise)
        prior_slopes = self.evaluations.prior_residuals(self.scaled)[1]
        prior = prior_slopes.T @ prior_slopes
        inverse = np.linalg.pinv(prior + np.sum(points, axis=0), hermitian=True)
        if self.points <= count + 1:
            return inverse, np.full(count, float(self.observed.size - count))
        left = np.linalg.solve(np.eye(count) - points @ inverse, scores[..., None])[..., 0]
        variances = np.diagonal(inverse @ points @ inverse, axis1=1, axis2=2)
        total = np.sum(variances, axis=0) + np.diag(inverse @ prior @ inverse)
        return inverse @ (prior + left.T @ left) @ inverse, total**2 / np.maximum(np.sum(variances**2, axis=0), 1e-300)


def fit(parameters: Sequence[Parameter], observed: np.ndarray, model: Model, noise: float | None = None) -> FitResult:
    """Estimates the parameters by nonlinear least squares with bounds. `observed` has the shape (point, sample). A point whose residuals
    are large as a whole is an outlier, whose weight is reduced (Cauchy's loss). The noise is the median of the residuals of the points,
    unless `noise` states that of a sample, as in the comparison of two models. The standard errors are those of a heteroscedastic
    model ("cluster-robust"), so that coloured noise and filters do not make them too small. Raises UsageError if the model cannot be
    computed at the start or does not depend on a parameter."""
    return Fit(parameters, observed, model).run(noise)
