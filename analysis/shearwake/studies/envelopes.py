# SPDX-License-Identifier: BSD-3-Clause
"""Envelopes of a focus with the largest efficiency, given the quadratic forms of a case (docs/explanation/best-modulation.md)."""
from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from scipy.optimize import minimize

MOST_ITERATIONS = 500  # of one local search; usually 100 suffice
TOLERANCE = 1e-9  # relative, of eta in the local search
ROUNDING = 1e-12  # relative
DEPTHS, PHASES = 20, 24  # of the grid of AM-STM
SEED = 1  # of the starts


@dataclass(frozen=True)
class Forms:
    """The quadratic forms of an envelope e, given by its values at the knots, in m²: the maximised measure is eta = e'Ne / e'De, the
    strength (e'Fe / S)^1/2 with the reference S, that is 1'F1 for the motion of the job. `path` has the shape (point, knot, knot): the
    mean of u² over time at a point of the drawn path is e'Ge. It has no points if the uniformity is not constrained."""

    numerator: np.ndarray
    denominator: np.ndarray
    focal: np.ndarray
    reference: float
    path: np.ndarray

    @property
    def knots(self) -> int:
        return len(self.numerator)

    def eta(self, envelope: np.ndarray) -> float:
        return float(envelope @ self.numerator @ envelope / (envelope @ self.denominator @ envelope))

    def squared_strength(self, envelope: np.ndarray) -> float:
        return float(envelope @ self.focal @ envelope / self.reference)

    def rms_along_path(self, envelope: np.ndarray) -> np.ndarray:
        """In m, one value per point."""
        return np.sqrt(np.maximum(0.0, self.path @ envelope @ envelope))  # rounding

    def uniformity(self, envelope: np.ndarray) -> float:
        """The smallest rms along the path divided by the mean, from 0 to 1."""
        rms = self.rms_along_path(envelope)
        return float(rms.min() / rms.mean()) if rms.any() else math.nan


def forms_in(document: dict[str, Any], count: int, reference: float | None = None) -> Forms:
    """The forms of a file for this number of knots, whose motion is that of the job unless `reference` states S. Raises ValueError and
    KeyError."""
    numerator, denominator, focal = (np.array(document[name], dtype=float) for name in ("numerator", "denominator", "focal"))
    path = np.array(document["path"], dtype=float).reshape(-1, count, count)
    if any(form.shape != (count, count) for form in (numerator, denominator, focal)):
        raise ValueError(f"its matrices do not have {count} rows and columns")
    return Forms(numerator, denominator, focal, float(focal.sum()) if reference is None else reference, path)


@dataclass(frozen=True)
class Envelope:
    """An envelope from 0 to 1 at the knots, its eta, and its strength relative to the unmodulated load."""

    values: np.ndarray
    eta: float
    strength: float


def measured(forms: Forms, values: np.ndarray) -> Envelope:
    return Envelope(values, forms.eta(values), math.sqrt(forms.squared_strength(values)))


@dataclass(frozen=True)
class Required:
    """What an envelope must reach, both from 0 to 1. A uniformity above 0 needs the forms of the path."""

    strength: float
    uniformity: float = 0.0

    def is_met_by(self, forms: Forms, envelope: np.ndarray) -> bool:
        if forms.squared_strength(envelope) < self.strength**2:
            return False
        return not self.uniformity > 0.0 or forms.uniformity(envelope) >= self.uniformity

    def is_nearly_met_by(self, forms: Forms, envelope: np.ndarray) -> bool:
        """The unmodulated load may miss a strength or uniformity of its own by rounding."""
        return Required(self.strength * (1.0 - ROUNDING), self.uniformity * (1.0 - ROUNDING)).is_met_by(forms, envelope)


def search_from(forms: Forms, required: Required, start: np.ndarray) -> np.ndarray:
    """A local maximum of eta near the start, which may violate the constraints by rounding: sequential quadratic programming
    (SLSQP; D. Kraft, DFVLR-FB 88-28, 1988)."""
    def loss(e: np.ndarray) -> tuple[float, np.ndarray]:
        n, d = forms.numerator @ e, forms.denominator @ e
        below = e @ d
        if not below > 0.0:  # a load that is never on
            return 0.0, np.zeros_like(e)
        eta = e @ n / below
        return -float(eta), 2.0 / below * (eta * d - n)

    constraints = [{"type": "ineq", "fun": lambda e: forms.squared_strength(e) - required.strength**2,
                    "jac": lambda e: 2.0 / forms.reference * (forms.focal @ e)}]
    if required.uniformity > 0.0:
        unit = forms.rms_along_path(np.ones(forms.knots)).mean()
        least = min(1.0, required.uniformity * (1.0 + 1e-9))  # rounding in the search must not violate the exact constraint

        def excess(e: np.ndarray) -> np.ndarray:
            rms = forms.rms_along_path(e) / unit
            return rms - least * rms.mean()

        def slopes(e: np.ndarray) -> np.ndarray:
            rms = forms.rms_along_path(e)[:, None] * unit
            slope = np.divide(forms.path @ e, rms, out=np.zeros((len(rms), len(e))), where=rms > 0.0)
            return slope - least * slope.mean(axis=0)

        constraints.append({"type": "ineq", "fun": excess, "jac": slopes})
    found = minimize(loss, start, jac=True, method="SLSQP", bounds=[(0.0, 1.0)] * forms.knots, constraints=constraints,
                     options={"ftol": TOLERANCE * forms.eta(np.ones(forms.knots)), "maxiter": MOST_ITERATIONS})
    return found.x if np.all(np.isfinite(found.x)) else start


def feasible(forms: Forms, required: Required, envelope: np.ndarray) -> np.ndarray | None:
    """An envelope on the way to the unmodulated load that satisfies all constraints, near the given one; None if neither that
    envelope nor the unmodulated load does. eta does not depend on the scale, so the largest value is 1."""
    ones = np.ones(forms.knots)
    envelope = np.clip(envelope, 0.0, 1.0)
    envelope = envelope / envelope.max() if envelope.max() > 0.0 else ones
    if required.is_met_by(forms, envelope):
        return envelope
    if not required.is_nearly_met_by(forms, ones):
        return None
    low, high = 0.0, 1.0
    for _ in range(60):
        middle = 0.5 * (low + high)
        is_met = required.is_met_by(forms, envelope + middle * (ones - envelope))
        low, high = (low, middle) if is_met else (middle, high)
    return envelope + high * (ones - envelope)


def best_from(forms: Forms, required: Required, start: np.ndarray) -> Envelope:
    """The better one of a start and of a local search from it. It satisfies all constraints exactly. If none is found, which is
    possible only if the unmodulated load does not satisfy them, its eta is 0."""
    best = Envelope(np.ones(forms.knots), 0.0, 0.0)
    if not Required(required.strength).is_nearly_met_by(forms, best.values):
        return best  # no other envelope of this motion is as strong
    first = feasible(forms, required, start)
    found = feasible(forms, required, search_from(forms, required, start if first is None else first))
    for values in (first, found):
        if values is not None and (reached := measured(forms, values)).eta > best.eta * (1.0 + ROUNDING):
            best = reached
    return best


def starts(knots: int, count: int) -> Iterator[np.ndarray]:
    """`count` different starts: the unmodulated load, pauses of a full force, sines of different frequencies and phases, and noise.
    The same for the same arguments."""
    yield np.ones(knots)
    random = np.random.default_rng(SEED)
    for number in range(1, count):
        if number % 4 == 0:
            yield random.random(knots)
        elif number % 4 == 1:  # two to a third of the knots' number of periods
            periods, phase = math.floor(2.0 + random.random() * knots / 6.0), random.random()
            yield 0.5 - 0.5 * np.cos(2.0 * np.pi * (periods * np.arange(knots) / knots + phase))
        else:  # one to four pauses, each up to a third of the knots long
            values = np.ones(knots)
            for _ in range(random.integers(1, 5)):
                values[(random.integers(knots) + np.arange(random.integers(1, max(1, knots // 3) + 1))) % knots] = 0.0
            yield values


def best_envelope(forms: Forms, required: Required, count: int, more: Sequence[np.ndarray] = ()) -> Envelope:
    """The best of the local searches from `count` starts and from `more`."""
    best = Envelope(np.ones(forms.knots), 0.0, 0.0)
    for start in (*starts(forms.knots, count), *more):
        if (found := best_from(forms, required, start)).eta > best.eta * (1.0 + ROUNDING):
            best = found
    return best


@dataclass(frozen=True)
class AmEnvelope:
    """An envelope of AM-STM, 1 - depth/2 (1 + cos(2 pi f t + phase)) at the knots."""

    frequency_Hz: float
    depth: float
    phase_rad: float
    envelope: Envelope


def best_am(forms: Forms, interval_s: float, required: Required, frequencies_Hz: Sequence[float]) -> AmEnvelope:
    """The AM-STM with the largest eta that meets the requirements, over these frequencies and a fine grid of depths and phases; the
    unmodulated load if none is better, with eta = 0 if it does not meet them either. `interval_s` is the time between knots."""
    plain = measured(forms, np.ones(forms.knots))
    best = AmEnvelope(0.0, 0.0, 0.0, plain if required.is_nearly_met_by(forms, plain.values) else replace(plain, eta=0.0))
    depths, phases = (grid.ravel() for grid in np.meshgrid(np.arange(1, DEPTHS + 1) / DEPTHS, np.arange(PHASES), indexing="ij"))
    for frequency_Hz in frequencies_Hz:
        turns = 2.0 * np.pi * (frequency_Hz * interval_s * np.arange(forms.knots) + phases[:, None] / PHASES)
        values = 1.0 - 0.5 * depths[:, None] * (1.0 + np.cos(turns))
        eta, below = (np.einsum("ki,ij,kj->k", values, form, values, optimize=True) for form in (forms.numerator, forms.denominator))
        for place in np.argsort(-eta / below):
            if not eta[place] / below[place] > best.envelope.eta:
                break
            am = AmEnvelope(frequency_Hz, float(depths[place]), 2.0 * math.pi * int(phases[place]) / PHASES, plain)
            found = measured(forms, am_values(am, forms.knots, interval_s))
            if found.eta > best.envelope.eta and required.is_met_by(forms, found.values):
                best = replace(am, envelope=found)
                break
    return best


def am_values(am: AmEnvelope, knots: int, interval_s: float) -> np.ndarray:
    """The functions of the C library, so that the ids of cases do not depend on the processor."""
    return np.array([1.0 - 0.5 * am.depth * (1.0 + math.cos(2.0 * math.pi * am.frequency_Hz * (knot * interval_s) + am.phase_rad))
                     for knot in range(knots)])
