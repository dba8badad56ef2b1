# SPDX-License-Identifier: BSD-3-Clause
"""The results of `shearwake optimise`: the cases of the optima and of the modulations that they are compared with, and the tables."""
from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from .envelopes import measured
from .optimum import MotionChange, OptimisedCase, Optimum, Sm, StudyError, Variant, differences_by
from .optimum_files import Row, Waveform, job_of_optimum, waveform_of, write_atomically
from .study import Moved, Reading, Study

AGREEMENT = 1e-5  # relative, of eta by the forms and by the case of an optimum, which has other nodes in time
KINDS = ("unmodulated", "optimum", "AM-STM", "SM-STM", "exported")
STRENGTH_KEY, MODULATION_KEY = "optimise.strength_at_least", "optimise.modulation"


@dataclass(frozen=True)
class Found:
    """An optimum with the cases of its result, by their modulation."""

    moved: Moved
    optimum: Optimum
    sm: str | None  # id of the best SM-STM
    waveform: Waveform | None
    variants: dict[str, Variant]

    @property
    def case(self) -> OptimisedCase:
        return self.moved.case


class Results:
    """The results of a study."""

    def __init__(self, study: Study) -> None:
        self.study, self.options = study, study.options

    def find(self, case: OptimisedCase, moved: Moved, optimum: Optimum) -> Found:
        """The cases of the result of an optimum."""
        sm, change, rate_Hz, waveform = self.study.best_sm(case, optimum.strength), optimum.change, self.options.update_rate_Hz, None
        if rate_Hz > 0.0:
            waveform = waveform_of(optimum.found.values, case.interval_of(change), case.repeat, rate_Hz, self.options.bits)
        # The unmodulated load as an envelope of ones: with the time samples of the others.
        variants = {"unmodulated": case.with_envelope(np.ones(case.knots)), "optimum": case.with_envelope(optimum.found.values, change),
                    "AM-STM": case.with_envelope(optimum.am.envelope.values),
                    **({"SM-STM": case.variant(sm=vars(case.sm[sm]))} if sm else {}),
                    **({"exported": case.variant(change, envelope=waveform.envelope)} if waveform else {})}
        return Found(moved, optimum, sm, waveform, variants)

    def robustness(self, found: Sequence[Found]) -> list[Row]:
        """The rows of the optima in other tissues and at other speeds."""
        chosen = [f for f in found if self.options.is_robust_strength(f.optimum.strength)]
        if not chosen:
            return []
        self.study.begin("robustness")
        pairs = [(f, name, [{**f.variants[kind], "readings_only": True, "difference": difference} for kind in ("unmodulated", "optimum")])
                 for case in self.study.cases for name, difference in differences_by(self.options.robust_to).items()
                 for f in chosen if f.case is case]  # consecutive cases share the transfer functions of their tissue
        described = iter(self.study.describe([variant for *_, variants in pairs for variant in variants]))
        pairs = [pair for pair in pairs if None not in (next(described), next(described))]
        if not pairs:
            return []
        cases: list[Variant] = [
            {**variant, "settings": [(STRENGTH_KEY, f.optimum.strength), ("optimise.difference", name), (MODULATION_KEY, kind)]}
            for f, name, variants in pairs for kind, variant in zip(("unmodulated", "optimum"), variants)]
        computed = self.study.compute("robustness", "Robustness of the optima of " + self.study.program.study["title"],
                                      [STRENGTH_KEY, "optimise.difference", MODULATION_KEY], cases)
        rows = [self.robust_row(f, name, optimum.eta, plain.eta, optimum.focal_rms_um / plain.focal_rms_um)
                for (f, name, _), (_, plain), (_, optimum) in zip(pairs, computed[::2], computed[1::2])]
        return rows + [row for f in chosen for row in self.rows_in_other_tissues(f)]

    def rows_in_other_tissues(self, found: Found) -> Iterator[Row]:
        """The rows of an optimum in the tissues of the other cases of the job, whose forms are known."""
        if found.optimum.change != MotionChange():
            return
        for number in found.case.other_tissues:
            other = self.study.cases[number]
            envelope = measured(self.study.forms[other.id], found.optimum.found.values)
            plain = self.study.forms[other.id].eta(np.ones(other.knots))
            yield self.robust_row(found, f"tissue of {other.id}", envelope.eta, plain, envelope.strength)

    @staticmethod
    def robust_row(found: Found, difference: str, eta: float, plain: float, strength: float) -> Row:
        return Row(found.case.id, found.case.settings, {
            "strength_at_least_1": found.optimum.strength, "difference": difference, "eta_found_1": eta, "eta_unmodulated_1": plain,
            "found_over_unmodulated_1": eta / plain, "strength_1": strength})

    def rows_of(self, found: Sequence[Found]) -> list[Row]:
        """Computes the cases of the results, and writes the waveforms and jobs of the optima. Raises StudyError if the case of an
        optimum does not have its eta."""
        self.study.begin("cases of the results")
        cases: list[Variant] = []
        places: dict[tuple[int, str], int] = {}  # of the result and its modulation
        for case in self.study.cases:
            in_case = [(n, f) for n, f in enumerate(found) if f.case is case]
            reference = len(cases)
            for kind in KINDS:  # consecutive cases have the same time samples, so that they share transfer functions
                for n, f in in_case:
                    if kind in f.variants:
                        places[n, kind] = len(cases)
                        cases.append({**f.variants[kind], "settings": [(STRENGTH_KEY, f.optimum.strength), (MODULATION_KEY, kind)],
                                      **({"reference": reference} if len(cases) > reference else {})})
        study = self.study.program.study
        computed = self.study.compute("", study["title"], [STRENGTH_KEY, MODULATION_KEY], cases, x=STRENGTH_KEY,
                                      series=[*study["swept_keys"], MODULATION_KEY])
        rows = []
        for n, f in enumerate(found):
            readings = {kind: computed[places[n, kind]][1] for kind in f.variants}
            reached, eta = readings["optimum"].eta, f.optimum.found.eta
            if not abs(reached - eta) <= AGREEMENT * eta:
                raise StudyError(f"case {computed[places[n, 'optimum']][0]} has {self.options.maximise} = {reached:.9g}, but the optimum "
                                 f"of case {f.case.id} with a strength of {f.optimum.strength:g} has {eta:.9g} by its quadratic forms, "
                                 f"which differs by more than a relative {AGREEMENT:g}: no table is written", 6)
            rows.append(self.row_of(f, readings))
            self.write_waveforms(f)
        return rows

    def row_of(self, found: Found, readings: dict[str, Reading]) -> Row:
        optimum, am, case = found.optimum, found.optimum.am, found.case
        plain, none = readings["unmodulated"], Reading()
        sm = case.sm[found.sm] if found.sm else Sm(math.nan, math.nan, math.nan)
        sm_reading = self.study.basis.get(found.sm, none) if found.sm else none
        cells: dict[str, Any] = {
            "strength_at_least_1": optimum.strength, "eta_optimum_1": optimum.found.eta, "strength_optimum_1": optimum.found.strength,
            "eta_ceiling_1": optimum.ceiling.eta, "ceiling_over_optimum_1": optimum.ceiling.eta / optimum.found.eta,
            "eta_computed_1": readings["optimum"].eta, "eta_unmodulated_1": optimum.eta_unmodulated, "eta_am_1": am.envelope.eta,
            "strength_am_1": am.envelope.strength, "am_frequency_Hz": am.frequency_Hz, "am_depth_1": am.depth,
            "am_phase_deg": math.degrees(am.phase_rad), "eta_sm_1": sm_reading.eta,
            "strength_sm_1": sm_reading.focal_rms_um / self.study.basis[case.plain_id].focal_rms_um, "sm_frequency_Hz": sm.frequency_Hz,
            "sm_deviation_m_s": sm.deviation_m_s, "sm_phase_deg": math.degrees(sm.phase_rad),
            **{f"uniformity_{name}_1": readings.get(kind, none).uniformity
               for name, kind in (("optimum", "optimum"), ("unmodulated", "unmodulated"), ("am", "AM-STM"), ("sm", "SM-STM"))}}
        if len(self.options.over) > 1:
            moved = {"speed_m_s": case.speed_m_s, **found.moved.described}
            cells |= {"optimum_size_1": optimum.change.size, "optimum_speed_m_s": moved["speed_m_s"],
                      "optimum_sm_frequency_Hz": moved.get("sm_frequency_Hz", math.nan),
                      "optimum_sm_deviation_m_s": moved.get("speed_deviation_m_s", math.nan),
                      "optimum_sm_phase_deg": moved.get("sm_phase_deg", math.nan)}
        is_valid = plain.is_valid and readings["optimum"].is_valid and sm_reading.is_valid
        if exported := readings.get("exported"):
            is_valid = is_valid and exported.is_valid
            cells |= {"eta_exported_1": exported.eta, "strength_exported_1": exported.focal_rms_um / plain.focal_rms_um,
                      "exported_loss_1": 1.0 - exported.eta / optimum.found.eta, "uniformity_exported_1": exported.uniformity}
        return Row(case.id, case.settings, {**cells, "valid": "yes" if is_valid else "no"})

    def write_waveforms(self, found: Found) -> None:
        """The jobs of an optimum and of its exported waveform, and the waveform itself."""
        stem, study = self.study.stem(found.case, found.optimum.strength), self.study.program.study
        for kind, envelope in (("", found.variants["optimum"]["envelope"]),
                               *([("exported.", found.waveform.envelope)] if found.waveform else [])):
            write_atomically(self.study.folder / f"{stem}.{kind}job.toml", job_of_optimum(
                study["job"], study["name"], found.case.settings, found.optimum.change, found.moved.described, envelope))
        if found.waveform:
            places = self.study.program.ask("positions", **found.moved.variant, times_s=found.waveform.times_s)
            write_atomically(self.study.folder / f"{stem}.csv", found.waveform.csv_text(places))
            write_atomically(self.study.folder / f"{stem}.toml", found.waveform.toml_text())
