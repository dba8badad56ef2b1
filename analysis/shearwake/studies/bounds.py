# SPDX-License-Identifier: BSD-3-Clause
"""Upper bounds of the efficiency of envelopes, with certificates that scripts/verify_certificate.py verifies."""
from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy.linalg import eigh, lapack

from .envelopes import Forms

RELATIVE_ACCURACY = 1e-4  # of eta
MOST_STEPS = 50  # of Newton's method for one sharpness


@dataclass(frozen=True)
class Certificate:
    """A proof that no envelope between 0 and 1 with at least this strength reaches `eta`: tau (m²), weights w >= 0 (m²) and mu >= 0
    for which, with M = F + mu (N - eta D), the matrix

        tau    -w'/2
        -w/2   diag(w) - M

    is positive semidefinite and tau < strength² S. Its form for (1, e) shows that e'Me <= tau - sum w e (1 - e) <= tau < strength² S,
    but an envelope that reached eta with this strength would have e'Me >= e'Fe >= strength² S. It holds for envelopes that are linear
    between the knots."""

    strength: float
    eta: float
    mu: float
    tau: float
    weights: np.ndarray

    def matrix(self, forms: Forms) -> np.ndarray:
        return certificate_matrix(forms.focal + self.mu * (forms.numerator - self.eta * forms.denominator), self.tau, self.weights)

    def is_valid(self, forms: Forms) -> bool:
        """If the least eigenvalue of the matrix is negative, by rounding, tau is increased by its amount times 1 + e'e, at most 1
        plus the number of knots."""
        if not self.mu >= 0.0 or not self.weights.min() >= 0.0:
            return False
        deficit = max(0.0, -float(np.linalg.eigvalsh(self.matrix(forms)).min()))
        return self.tau + deficit * (1 + forms.knots) < self.strength**2 * forms.reference

    def relaxed_envelope(self, forms: Forms) -> np.ndarray:
        """The envelope of the semidefinite program of the bound, from 0 to 1: near the best envelope where the bound is tight, but it
        may be too weak."""
        first = np.linalg.solve(self.matrix(forms) / self.tau, np.eye(1 + forms.knots)[0])
        return np.clip(first[1:] / first[0], 0.0, 1.0)


def certificate_matrix(form: np.ndarray, tau: float, weights: np.ndarray) -> np.ndarray:
    matrix = np.empty((len(weights) + 1, len(weights) + 1))
    matrix[0, 0] = tau
    matrix[0, 1:] = matrix[1:, 0] = -0.5 * weights
    matrix[1:, 1:] = -form
    matrix.ravel()[len(weights) + 2::len(weights) + 2] += weights
    return matrix


class BarrierSolver:
    """Minimises tau over tau, w >= 0 and mu >= 0 with the matrix of a certificate positive semidefinite: a logarithmic barrier with
    Newton's method (S. Boyd and L. Vandenberghe, Convex Optimization, chapter 11, 2004). The variables are (tau, w, mu)."""

    def __init__(self, focal: np.ndarray, gain: np.ndarray) -> None:
        self.focal, self.gain = focal, gain
        rows = np.abs(focal + gain).sum(axis=1)
        # With 2 w the matrix is diagonally dominant if tau is at least the sum of w.
        weights = 2.0 * rows + 2.0 / len(rows)
        self.x = np.concatenate(([weights.sum()], weights, [1.0]))

    def reaches(self, target: float) -> bool:
        """Whether tau becomes less than the target before a lower bound of the minimum proves that it does not."""
        terms, sharpness = 2 * len(self.x) - 2, 10.0
        while sharpness < 1e9:
            for _ in range(MOST_STEPS):
                decrement = self.newton_step(sharpness)
                if self.x[0] < target:
                    return True
                if decrement < 1e-3:
                    break
            # At the centre the duality gap is terms / sharpness; twice that, since it is reached approximately.
            if self.x[0] - 2.0 * terms / sharpness > target:
                return False
            sharpness *= 4.0
        return False

    def factor(self, x: np.ndarray) -> np.ndarray | None:
        """The Cholesky factor of the matrix; None outside of the constraints."""
        if not x[1:].min() > 0.0:
            return None
        factor, info = lapack.dpotrf(certificate_matrix(self.focal + x[-1] * self.gain, x[0], x[1:-1]), lower=1)
        return factor if info == 0 else None

    def barrier(self, x: np.ndarray, factor: np.ndarray, sharpness: float) -> float:
        return float(sharpness * x[0] - 2.0 * np.log(np.diagonal(factor)).sum() - np.log(x[1:]).sum())

    def derivatives(self, factor: np.ndarray, sharpness: float) -> tuple[np.ndarray, np.ndarray]:
        """Gradient and Hessian of the barriers. The matrix depends on w_i by (a b' + b a') / 2 with the unit vector a = i and
        b = i - 0."""
        inverse = lapack.dpotri(factor, lower=1)[0]  # its lower triangle; the other one is 0
        inverse = inverse + inverse.T - np.diag(np.diagonal(inverse))
        weights, mu, n = self.x[1:-1], self.x[-1], len(self.x) - 2
        corner, edge, aa = inverse[0, 0], inverse[1:, 0], inverse[1:, 1:]
        ab = aa - edge[:, None]  # row i, column j: a_j' inverse b_i
        bb = ab - edge + corner
        product, gain_edge = aa @ self.gain, self.gain @ edge
        gradient = np.concatenate(([sharpness - corner], -(np.diagonal(ab) + 1.0 / weights), [np.trace(product) - 1.0 / mu]))
        hessian = np.empty((n + 2, n + 2))
        hessian[0, 0] = corner**2
        hessian[0, 1:-1] = edge**2 - corner * edge
        hessian[0, -1] = -edge @ gain_edge
        hessian[1:-1, 1:-1] = 0.5 * (aa * bb + ab * ab.T) + np.diag(weights**-2.0)
        hessian[1:-1, -1] = aa @ gain_edge - np.einsum("ij,ji->i", product, aa)
        hessian[-1, -1] = np.sum(product * product.T) + mu**-2.0
        return gradient, hessian

    def newton_step(self, sharpness: float) -> float:
        """Returns the square of the Newton decrement before the step."""
        factor = self.factor(self.x)
        assert factor is not None
        gradient, hessian = self.derivatives(factor, sharpness)
        _, _, step, info = lapack.dsysv(hessian, -gradient)
        slope = float(gradient @ step)
        if info != 0 or not slope < 0.0:
            return 0.0
        before, length = self.barrier(self.x, factor, sharpness), 1.0
        while length > 1e-12:
            x = self.x + length * step
            reached = self.factor(x)
            if reached is not None and self.barrier(x, reached, sharpness) <= before + 0.1 * length * slope:
                self.x = x
                return -slope
            length *= 0.5
        return 0.0


def greatest_eta(forms: Forms) -> float:
    """The largest eta of any envelope, also with negative values and any strength."""
    scale = np.trace(forms.denominator) / forms.knots
    denominator = forms.denominator / scale + 1e-12 * np.eye(forms.knots)  # rounding may have made an eigenvalue negative
    return float(eigh(forms.numerator / scale, denominator, eigvals_only=True).max())


def ceiling(forms: Forms, strength: float) -> Certificate:
    """The smallest eta, to a relative 1e-4, for which there is a certificate: bisection over eta, and for each a semidefinite
    program."""
    # Units in which the reference has a focal energy, and the unmodulated load a total energy, of 1.
    focal_unit, unit = forms.reference, float(forms.denominator.sum())

    def attempt(eta: float) -> Certificate | None:
        solver = BarrierSolver(forms.focal / focal_unit, (forms.numerator - eta * forms.denominator) / unit)
        if not solver.reaches(strength**2 * (1.0 - 1e-9)):  # a margin for rounding, far below the accuracy of eta
            return None
        return Certificate(strength, eta, float(solver.x[-1]) * focal_unit / unit, float(solver.x[0]) * focal_unit,
                           solver.x[1:-1] * focal_unit)

    reached, excluded = forms.eta(np.ones(forms.knots)), 1.001 * greatest_eta(forms) + 1e-9
    while (best := attempt(excluded)) is None:
        excluded *= 1.1  # the eigenvalue was in error by rounding
    while best.eta - reached > RELATIVE_ACCURACY * best.eta:
        middle = 0.5 * (reached + best.eta)
        if found := attempt(middle):
            best = found
        else:
            reached = middle
    return best
