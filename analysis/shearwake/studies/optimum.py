# SPDX-License-Identifier: BSD-3-Clause
"""The cases that `shearwake optimise` compares, the motions that it tries, and the optima with their files."""
from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from ..checksum import Damaged, read_json, sealed
from ..errors import ProgramError
from ..inputs import text_of
from .bounds import Certificate, ceiling
from .envelopes import AmEnvelope, Envelope, Forms, Required, best_am, best_envelope, forms_in, measured

LARGEST_DEVIATION = 0.6  # of an oscillating speed, relative to the mean
FEWEST_KNOTS_PER_PERIOD = 6.0  # of AM-STM
MOST_SM_PERIODS = 5
FIRST_DEVIATION, DEVIATION_STEP = 0.45, 0.15  # of SM-STM, relative to the speed

Variant = dict[str, Any]
"""A case for the program: the number of the optimised case, and what differs from it (src/studies/optimise/study.hpp)."""


class StudyError(ProgramError):
    """The study cannot continue; `exit_code` is that of the command."""

    def __reduce__(self) -> tuple[type[StudyError], tuple[str, int]]:
        return StudyError, (str(self), self.exit_code)  # workers raise it too


@dataclass(frozen=True)
class Options:
    """The table [optimise] of a job, in SI units."""

    maximise: str
    over: list[str]
    knot_s: float
    strengths: list[float]
    uniformity: float
    starts: int
    factor_at_most: float
    rounds: int
    am_frequencies_Hz: list[float]
    sm_frequencies_Hz: list[float]
    sm_deviations_m_s: list[float]
    robust_to: float
    robust_strengths: list[float]
    update_rate_Hz: float
    bits: int

    @property
    def identity(self) -> str:
        """The options on which the optima depend."""
        left_out = {"robust_to", "robust_strengths", "update_rate_Hz", "bits", *(["uniformity"] if not self.uniformity > 0.0 else [])}
        return "".join(f"{name} = {value}\n" for name, value in asdict(self).items() if name not in left_out)

    def is_robust_strength(self, strength: float) -> bool:
        return self.robust_to > 0.0 and (not self.robust_strengths or strength in self.robust_strengths)


@dataclass(frozen=True)
class Sm:
    """One SM-STM on the path of a case."""

    frequency_Hz: float
    deviation_m_s: float
    phase_rad: float


@dataclass(frozen=True)
class MotionChange:
    """A change of the motion relative to the job: factors of the size and the mean speed v, and the speed
    v (1 + sine sin(2 pi f t) + cosine cos(2 pi f t)) with `periods` periods in the window of the measures."""

    size: float = 1.0
    speed: float = 1.0
    periods: int = 0
    sine: float = 0.0
    cosine: float = 0.0


@dataclass
class OptimisedCase:
    """A case whose envelope is optimised. `sm` contains the SM-STM that are computed, by the id of their case, `plain_id` is that of
    the unmodulated load, and `other_tissues` numbers the cases that differ in the tissue alone."""

    id: str
    settings: list[tuple[str, Any]]
    knots: int
    interval_s: float
    repeat: bool
    window_s: float
    speed_m_s: float | None
    other_tissues: list[int]
    number: int = 0
    plain_id: str = ""
    sm: dict[str, Sm] = field(default_factory=dict)

    def variant(self, change: MotionChange = MotionChange(), **parts: Any) -> Variant:
        motion = {"motion": asdict(change)} if change != MotionChange() else {}
        return {"case": self.number, **motion, **parts}

    def interval_of(self, change: MotionChange) -> float:
        """The time between knots in s, which follows the duration of a pass."""
        return self.interval_s * (change.size / change.speed) if change != MotionChange() else self.interval_s

    def with_envelope(self, values: Sequence[float] | np.ndarray, change: MotionChange = MotionChange(), **parts: Any) -> Variant:
        return self.variant(change, envelope=envelope_of([float(v) for v in values], self.interval_of(change), self.repeat), **parts)

    def am_frequencies_Hz(self, options: Options) -> list[float]:
        """Those of the options, or whole numbers of periods in the window with enough knots per period."""
        lowest = 1.0 / self.window_s
        most = math.floor((1.0 + 1e-9) / (lowest * self.interval_s * FEWEST_KNOTS_PER_PERIOD))
        return options.am_frequencies_Hz or [periods * lowest for periods in range(1, most + 1)]

    def first_sm(self, options: Options) -> list[Sm]:
        """One to five periods in the window, four phases, and a deviation of 0.45 times the speed, or those of the options."""
        if self.speed_m_s is None:
            return []
        frequencies = options.sm_frequencies_Hz or [periods / self.window_s for periods in range(1, MOST_SM_PERIODS + 1)]
        deviations = options.sm_deviations_m_s or [FIRST_DEVIATION * self.speed_m_s]
        return [Sm(f, d, 0.5 * math.pi * quarter) for f in frequencies for d in deviations for quarter in range(4)]

    def sm_around(self, centre: Sm, step: float, options: Options) -> list[Sm]:
        """Phases that differ by `step` times 45 degrees and, unless the options fix it, deviations that differ by `step` times 0.15
        times the speed, up to 0.6 times it."""
        turn, speed, found = 2.0 * math.pi, self.speed_m_s or 0.0, []
        for sign in (1.0, -1.0):
            phase = centre.phase_rad + sign * step * 0.125 * turn
            found.append(replace(centre, phase_rad=phase - turn * math.floor(phase / turn)))
            deviation = min(centre.deviation_m_s + sign * step * DEVIATION_STEP * speed, LARGEST_DEVIATION * speed)
            if not options.sm_deviations_m_s and deviation > 0.0 and deviation != centre.deviation_m_s:
                found.append(replace(centre, deviation_m_s=deviation))
        return found

    def motion_of(self, sm: Sm) -> MotionChange | None:
        """None if it has no whole number of periods in the window of the measures."""
        periods = sm.frequency_Hz * self.window_s
        if self.speed_m_s is None or abs(periods - round(periods)) > 1e-6:
            return None
        deviation = sm.deviation_m_s / self.speed_m_s
        return MotionChange(periods=round(periods), sine=deviation * math.cos(sm.phase_rad), cosine=deviation * math.sin(sm.phase_rad))


def envelope_of(values: list[float], interval_s: float, repeat: bool) -> dict[str, Any]:
    return {"interval_s": interval_s, "repeat": repeat, "values": values}


def changes_around(centre: MotionChange, step: float, options: Options) -> list[MotionChange]:
    """Each varied quantity increased and decreased. A step of 1 reaches the largest factor or half of the largest deviation."""
    limit = options.factor_at_most
    factor, found = limit**step, []
    for part in options.over:
        for sign in (1.0, -1.0):
            by, deviation = factor if sign > 0.0 else 1.0 / factor, sign * 0.5 * step * LARGEST_DEVIATION
            if part in ("speed", "size"):
                found.append(replace(centre, **{part: min(max(getattr(centre, part) * by, 1.0 / limit), limit)}))
            if part == "speed-profile":  # at constant speed, the number of periods is free
                for periods in [centre.periods] if centre.periods > 0 else [1, 2, 3]:
                    found += [replace(centre, periods=periods, sine=centre.sine + deviation),
                              replace(centre, periods=periods, cosine=centre.cosine + deviation)]
    return [change for change in found if change != centre and math.hypot(change.sine, change.cosine) <= LARGEST_DEVIATION]


def differences_by(relative: float) -> dict[str, dict[str, float]]:
    """Factors of c_s and the viscosities in all combinations, and of the speed, by their name."""
    found: dict[str, dict[str, float]] = {}
    factors = (1.0 - relative, 1.0, 1.0 + relative)
    for c_s in factors:
        for viscosity in factors:
            found[difference_name(c_s=c_s, viscosity=viscosity)] = {"c_s": c_s, "viscosity": viscosity, "speed": 1.0}
    for speed in factors:
        found[difference_name(speed=speed)] = {"c_s": 1.0, "viscosity": 1.0, "speed": speed}
    return {name: factor for name, factor in found.items() if name}


def difference_name(**factors: float) -> str:
    return ", ".join(f"{name} {100.0 * (factor - 1.0):+.0f} %" for name, factor in factors.items() if factor != 1.0)


@dataclass(frozen=True)
class Optimum:
    """The results for one case and strength. The best AM-STM and `eta_unmodulated` have the motion of the job."""

    strength: float
    change: MotionChange
    found: Envelope
    ceiling: Certificate
    am: AmEnvelope
    eta_unmodulated: float

    def text(self, case_id: str, forms_id: str) -> str:
        def listed(envelope: Envelope) -> dict[str, Any]:
            return {**vars(envelope), "values": envelope.values.tolist()}
        bound = {name: value for name, value in vars(self.ceiling).items() if name != "strength"}
        return sealed({"schema": 1, "case": case_id, "forms": forms_id, "strength_at_least": self.strength, "motion": asdict(self.change),
                       "found": listed(self.found), "ceiling": {**bound, "weights": self.ceiling.weights.tolist()},
                       "am": {**vars(self.am), "envelope": listed(self.am.envelope)}, "eta_unmodulated": self.eta_unmodulated})


def find_optimum(case: OptimisedCase, forms: Forms, change: MotionChange, moved: Forms, strength: float, options: Options) -> Optimum:
    """Searches for the best envelope, proves the bound, and finds the best AM-STM. `forms` and `moved` belong to the motion of the job
    and to the changed one. Raises StudyError if no envelope has the required uniformity."""
    required = Required(strength, options.uniformity)
    am = best_am(forms, case.interval_s, required, case.am_frequencies_Hz(options))
    bound = ceiling(moved, strength)
    relaxed = bound.relaxed_envelope(moved)
    # Also with full force or none according to several limits.
    more = [relaxed, *((relaxed > limit).astype(float) for limit in (0.25, 0.5, 0.75)), am.envelope.values]
    found = best_envelope(moved, required, options.starts, more)
    if options.uniformity > 0.0 and not found.eta > 0.0:
        raise StudyError(f"case {case.id}: no envelope was found with a strength of {strength:g} and optimise.uniformity = "
                         f"{options.uniformity:g}; the unmodulated load has a uniformity of {moved.uniformity(np.ones(moved.knots)):.4g}, "
                         "so choose a smaller value", 3)
    return Optimum(strength, change, found, bound, am, forms.eta(np.ones(forms.knots)))


def read_checked(path: Path, use: Callable[[Any], Any]) -> Any:
    """What `use` makes of the sealed JSON text of a file. Raises StudyError for a damaged file."""
    try:
        return use(read_json(text_of(path)))
    except (Damaged, ValueError, KeyError, TypeError) as error:
        reason = f"it has no member {error}" if isinstance(error, KeyError) else error
        raise StudyError(f"{path} is damaged: {reason}; remove it, and rerun the command", 6) from None


def change_in(path: Path) -> MotionChange:
    """The motion of a stored optimum. Raises StudyError."""
    return read_checked(path, lambda document: MotionChange(**document["motion"]))


def read_forms(path: Path, knots: int, reference: float | None = None) -> Forms:
    return read_checked(path, lambda document: forms_in(document, knots, reference))


def read_optimum(path: Path, case: OptimisedCase, strength: float, forms: Forms, moved: Forms) -> Optimum:
    """A stored optimum, whose numbers are computed again from the forms. Raises StudyError if it belongs to another case or its
    certificate is not valid."""
    def envelope(document: Any, its_forms: Forms) -> Envelope:
        found = measured(its_forms, np.array(document["values"], dtype=float))
        return replace(found, eta=0.0) if document["eta"] == 0.0 else found  # it does not meet the requirements

    def use(document: Any) -> Optimum:
        bound, am = document["ceiling"], document["am"]
        certificate = Certificate(strength, bound["eta"], bound["mu"], bound["tau"], np.array(bound["weights"], dtype=float))
        if document["strength_at_least"] != strength or document["case"] != case.id or not certificate.is_valid(moved):
            raise ValueError("it belongs to another case or strength, or its certificate is not valid")
        best = AmEnvelope(am["frequency_Hz"], am["depth"], am["phase_rad"], envelope(am["envelope"], forms))
        return Optimum(strength, MotionChange(**document["motion"]), envelope(document["found"], moved), certificate, best,
                       forms.eta(np.ones(forms.knots)))
    return read_checked(path, use)
