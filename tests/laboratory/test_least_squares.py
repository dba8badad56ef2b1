# SPDX-License-Identifier: BSD-3-Clause
"""Estimates, intervals and outliers of shearwake.studies.least_squares for a decaying wave with known speed and attenuation."""
import unittest
from dataclasses import replace

import numpy as np

from shearwake import UsageError
from shearwake.studies.least_squares import Parameter, Prior, fit

POINTS, SAMPLES = 30, 60
SPEED, DECAY = 2.5, 15.0
PARAMETERS = [Parameter("speed", 2.3, 1.0, 5.0), Parameter("decay", 10.0, 0.0, 100.0)]


def wave(values):
    """A decaying wave of 200 Hz along a line of 60 mm."""
    x, t = 2e-3 * np.arange(POINTS)[:, None], 2e-4 * np.arange(SAMPLES)
    return np.exp(-values[1] * x) * np.sin(2.0 * np.pi * 200.0 * (t - x / values[0]))


def noisy(seed, coloured=False):
    """With noise of a standard deviation of 0.1, either white or a moving average of five samples."""
    noise = np.random.default_rng(seed).normal(size=(POINTS, SAMPLES + 4))
    if coloured:
        noise = sum(noise[:, n:n + SAMPLES] for n in range(5)) / np.sqrt(5.0)
    return wave((SPEED, DECAY)) + 0.1 * noise[:, :SAMPLES]


def holds(estimate, truth):
    return estimate.low_95 <= truth <= estimate.high_95


class LeastSquares(unittest.TestCase):
    def test_the_true_values_lie_in_the_95_percent_intervals_of_90_of_100_seeds(self):
        # Of a binomial distribution with 95 %, 88 or fewer of 100 occur once in 230 times.
        for coloured in (False, True):
            with self.subTest(coloured=coloured):
                results = [fit(PARAMETERS, noisy(seed, coloured), wave) for seed in range(100)]
                self.assertTrue(all(result.has_converged for result in results))
                for n, truth in enumerate((SPEED, DECAY)):
                    self.assertGreaterEqual(sum(holds(result.estimates[n], truth) for result in results), 90)

    def test_points_with_a_wrong_signal_change_the_estimates_little(self):
        rows = noisy(7)
        rows[[4, 11, 23]] = np.where(np.arange(SAMPLES) % 2 == 0, 3.0, -2.0)
        result = fit(PARAMETERS, rows, wave)
        self.assertAlmostEqual(result.estimates[0].value, SPEED, delta=0.02 * SPEED)
        self.assertAlmostEqual(result.estimates[1].value, DECAY, delta=0.1 * DECAY)
        self.assertLess(result.weights[11], 0.05)
        self.assertGreater(result.weights[12], 0.5)
        self.assertEqual(result.outliers, 3)
        self.assertAlmostEqual(result.noise, 0.1, delta=0.01)  # the median of 30 points

    def test_priors_and_bounds_limit_the_estimates(self):
        rows = noisy(1)
        bounded = fit([PARAMETERS[0], replace(PARAMETERS[1], high=12.0)], rows, wave).estimates[1]
        self.assertAlmostEqual(bounded.value, 12.0)
        self.assertTrue(bounded.is_at_bound)
        for prior in (Prior(11.0, 1e-3), Prior(np.log(11.0), 1e-4, True)):
            informed = fit([PARAMETERS[0], replace(PARAMETERS[1], prior=prior)], rows, wave).estimates[1]
            self.assertAlmostEqual(informed.value, 11.0, delta=0.01)
            self.assertLess(informed.standard_error, 1.2e-3)

    def test_a_known_noise_is_used_instead_of_that_of_the_residuals(self):
        rows = noisy(3)
        estimated, known, large = (fit(PARAMETERS, rows, wave, noise) for noise in (None, 0.1, 1.0))
        self.assertEqual((known.noise, large.noise), (0.1, 1.0))
        # Each point contributes 4 samples log(1 + 1 / 4) at its expected residual; 3 % of 1800 samples, and more.
        self.assertAlmostEqual(known.chi_squared / (4.0 * np.log(1.25) * rows.size), 1.0, delta=0.1)
        self.assertAlmostEqual(large.chi_squared / (0.01 * rows.size), 1.0, delta=0.1)
        # Robust intervals depend on the residuals and not on the noise, apart from the weights.
        error = estimated.estimates[0].standard_error
        self.assertAlmostEqual(large.estimates[0].standard_error / error, 1.0, delta=0.2)
        self.assertAlmostEqual(large.estimates[0].value, estimated.estimates[0].value, delta=0.5 * error)

    def test_a_parameter_that_few_points_determine_has_a_wide_interval(self):
        def levels(values):
            """The level of three points and that of the other 27."""
            return np.where(np.arange(POINTS)[:, None] < 3, values[0], values[1]) * np.ones(SAMPLES)

        parameters = [Parameter("three", 0.9, 0.0, 2.0), Parameter("others", 0.9, 0.0, 2.0)]
        held = 0
        for seed in range(100):
            three, others = fit(parameters, noisy(seed, True) - wave((SPEED, DECAY)) + 1.0, levels).estimates
            # Quantiles of Student's distribution with 3 and 27 degrees of freedom.
            self.assertAlmostEqual((three.high_95 - three.value) / three.standard_error, 3.18, delta=0.16)
            self.assertAlmostEqual((others.high_95 - others.value) / others.standard_error, 2.05, delta=0.04)
            held += holds(three, 1.0)
        self.assertGreaterEqual(held, 90)

    def test_data_without_noise_give_the_exact_values(self):
        speed, decay = fit(PARAMETERS, wave((SPEED, DECAY)), wave).estimates
        self.assertAlmostEqual(speed.value / SPEED, 1.0, delta=1e-5)  # tolerance of the solver
        self.assertAlmostEqual(decay.value / DECAY, 1.0, delta=1e-4)

    def test_a_step_to_values_without_a_case_is_shortened(self):
        def limited(values):
            return wave(values) if values[0] < 2.6 else None

        self.assertAlmostEqual(fit(PARAMETERS, noisy(1), limited).estimates[0].value, SPEED, delta=0.02 * SPEED)

    def test_a_parameter_without_effect_and_a_model_that_fails_are_rejected(self):
        with self.assertRaisesRegex(UsageError, "does not depend on unused"):
            fit([*PARAMETERS, Parameter("unused", 1.0, 0.0, 2.0)], noisy(1), wave)
        with self.assertRaisesRegex(UsageError, "cannot be computed with the start values"):
            fit(PARAMETERS, noisy(1), lambda _: None)
