# SPDX-License-Identifier: BSD-3-Clause
"""Which cases of a sweep may be compared, and which of them has the largest value of a column."""
from __future__ import annotations

import math
from dataclasses import dataclass, field

from ..case import Case
from . import contrast, layout
from .answer import NOTICEABLE_dB, Quantity, is_at_rest, quantity
from .load import Selection, remembered
from .numerical_error import is_numerical, numerical_variants, relative_error, settings_that_differ, spread_of, valid
from .places import keys_of
from .warnings_of import RATE, is_valid

SHAPES = {"hold": "a point", "swing": "a line", "line": "a line", "arc": "a circle", "polyline": "a polygon", "lissajous": "a Lissajous curve"}
STUDIES = "docs/explanation/user-studies.md"
SAME_REGION = 0.03  # relative: grids of different spacing round the sides of the domain to whole cells


@dataclass
class Ranking:
    """The valid cases in groups that may be compared, and the result of the only group. `equal`: the best cases, whose values read
    the same; `near`: cases that differ from them by no more than `margin`, which has a reason. `seeks_least`: the best
    case has the smallest value. `pairs`: cases with a body and without it."""
    quantity: Quantity
    cases: list[Case]
    groups: list[list[Case]]
    reason: str = ""
    equal: list[Case] = field(default_factory=list)
    near: list[Case] = field(default_factory=list)
    margin: str = ""
    seeks_least: bool = False
    pairs: list[tuple[Case, Case]] = field(default_factory=list)

    @property
    def best(self) -> Case | None:
        return self.equal[0] if self.equal else None

    @property
    def others(self) -> list[Case]:
        return [c for c in self.cases if c not in self.equal and c not in self.near]

    def value(self, case: Case) -> float:
        return case.value(self.quantity.column, math.nan)


def shape(case: Case) -> str:
    """What the load draws: 'a point', '4 points', 'a circle'; '' if that is not recorded."""
    moves = [move.get("mover", "") for move in case.setting("load", "modulation", "trajectory", default=[])]
    foci = len(case.setting("load", "modulation", "foci_x_m", default=[0.0]))
    moving = [move for move in moves if move != "hold"] or moves
    name = SHAPES.get(moving[0], "a path") if moving else ""
    return name.replace("a ", f"{foci} ", 1) + "s" if foci > 1 and name else name


def region_mm2(case: Case) -> float:
    """The area of the measured region, which is the domain without its sponge unless the job states another."""
    area = case.value("region_mm2", math.nan)
    spacing_mm, sponge_mm = (1e3 * case.setting("domain", key, default=math.nan) for key in ("spacing_m", "sponge_m"))
    sides = [case.setting("domain", key, default=math.nan) * spacing_mm - 2.0 * sponge_mm for key in ("nx", "ny")]
    return sides[0] * sides[1] if math.isnan(area) else area


def window_s(case: Case) -> tuple[float, float]:
    """The time over which a case is averaged; (0, 0) in the periodic regime, in which every period is alike."""
    if layout.repeats(case):
        return 0.0, 0.0
    begin, end = (case.setting("measure", key, default=0.0) for key in ("settled_after_s", "at_s"))
    return begin, end


def depends_on_region(column: str) -> bool:
    return not column.endswith(RATE) and column not in ("felt_path_dB", "felt_peak_dB")


def have_same_region(one: Case, other: Case) -> bool:
    areas = region_mm2(one), region_mm2(other)
    return any(map(math.isnan, areas)) or abs(areas[0] - areas[1]) <= SAME_REGION * max(areas)


def difference(column: str, one: Case, other: Case) -> str:
    """Why a column of two cases is not comparable; '' if it is."""
    if shape(one) != shape(other):
        return "loads of different shapes"
    if depends_on_region(column) and not have_same_region(one, other):
        return "cases with different measured regions"
    if depends_on_region(column) and not all(
            math.isclose(a, b, rel_tol=0.0, abs_tol=1e-9) for a, b in zip(window_s(one), window_s(other))):
        return "cases with different time windows"
    return ""


def comparable(column: str, cases: list[Case]) -> tuple[list[list[Case]], str]:
    """The cases in groups within which a column is comparable, and why there are several."""
    groups: list[list[Case]] = []
    for case in cases:
        same = next((g for g in groups if not difference(column, g[0], case)), None)
        if same is None:
            groups.append([case])
        else:
            same.append(case)
    return groups, difference(column, groups[0][0], groups[1][0]) if len(groups) > 1 else ""


@remembered
def reference_for(selection: Selection, case: Case, column: str = "eta_period_1") -> Case | None:
    """The reference of a case, or else the same case without a body, if both are valid and the column is comparable; None for a
    reference."""
    found = selection.reference_of(case) or contrast.counterpart(selection, case)
    if not found or found is case or not is_valid(case) or not is_valid(found) or difference(column, case, found):
        return None
    return None if math.isnan(found.value(column, math.nan)) else found


def representatives(cases: list[Case], column: str) -> list[Case]:
    """The case with the largest value among those that differ only in numerical parameters."""
    found: dict[str, Case] = {}
    for case in sorted(cases, key=lambda c: -c.value(column)):
        found.setdefault(str({k: v for k, v in case.settings.items() if not is_numerical(k)}), case)
    return [c for c in cases if c in found.values()]


def margin(selection: Selection, best: Case, of: Quantity) -> tuple[float, str]:
    """The difference from the best case below which another case does not differ, and its reason."""
    if of.is_level:
        return NOTICEABLE_dB, ""
    variants = numerical_variants(selection, best, of.column)
    relative = relative_error(selection, best, of.column)[0]
    error = 2.0 * relative * abs(best.value(of.column)) if not math.isnan(relative) else 0.0
    spread = spread_of(variants, of.column)[0] if len(variants) > 1 else 0.0
    if spread > error:
        return spread, f"within the difference between {settings_that_differ(variants)}"
    return error, "within the numerical error"


@remembered
def rank(selection: Selection, column: str) -> Ranking:
    """Ranks the valid cases by a column. Cases that are averaged over different times are ranked by the ratio to their references,
    which are averaged over the same times."""
    of = quantity(selection, column)
    cases = valid(selection, column)
    groups, reason = comparable(column, cases)
    if reason == "cases with different time windows" and len({shape(c) for c in cases}) == 1 and all(
            have_same_region(cases[0], c) for c in cases):
        ratio = selection.ratio_of(column)
        if ratio and all(reference_for(selection, c, column) for c in cases):
            of, groups = quantity(selection, ratio), [cases]
    found = Ranking(of, cases, groups, reason)
    if len(groups) != 1 or not of.seeks_most:
        return found
    found.pairs = [(c, other) for c in cases if (other := reference_for(selection, c, column)) and other is contrast.counterpart(selection, c)
                   and not selection.reference_of(c)]
    if found.pairs:
        found.equal = [max(found.pairs, key=lambda pair: abs(change(of, found.value(pair[0]), found.value(pair[1]))))[0]]
        return found
    found.cases = representatives(cases, of.column)
    found.seeks_least = any(axis["goal"] == "minimum" and axis["column"] == of.column for axis in selection.sweep.adaptive_axes)
    sign = -1.0 if found.seeks_least else 1.0
    best = max(found.cases, key=lambda c: sign * found.value(c))
    size, found.margin = margin(selection, best, of)
    close = [c for c in found.cases if c is not best and abs(found.value(c) - found.value(best)) < size]
    alike = [c for c in found.cases if of.text(found.value(c)) == of.text(found.value(best))] if not of.is_level else [best]
    if of.column in {axis["column"] for axis in selection.sweep.adaptive_axes}:
        alike, close = [best], []  # neighbouring points of a search
    found.equal = alike
    found.near = sorted((c for c in close if c not in alike), key=lambda c: -sign * found.value(c))
    return found


def change(of: Quantity, value: float, reference: float) -> float:
    """How much larger a value is than another: a difference of levels in dB, else a relative difference."""
    if of.is_level:
        return value - reference
    return value / reference - 1.0 if reference else math.nan


def edges(selection: Selection, ranking: Ranking) -> list[str]:
    """The numeric keys at an end of whose swept range the best case lies, among the cases with the same other settings. Phases have no
    end, and depths of a modulation none beyond 0 and 1."""
    keys = keys_of(selection)
    found = []
    for key in keys:
        values = {c.settings.get(key) for c in ranking.cases}
        if key.endswith(("_deg", "_depth")) or not all(map(layout.is_number, values)) or any((key, v) in layout.labels(selection) for v in values):
            continue

        def is_at_end(case: Case, key: str = key) -> bool:
            line = [c.settings[key] for c in ranking.cases if all(c.settings.get(k) == case.settings.get(k) for k in keys if k != key)]
            return len(set(line)) > 1 and case.settings[key] in (min(line), max(line))
        if all(map(is_at_end, ranking.equal)):
            found.append(key)
    return found


def middle_case(selection: Selection, column: str) -> Case | None:
    """The valid case with the median of a column."""
    cases = sorted(valid(selection, column), key=lambda c: c.value(column))
    return cases[len(cases) // 2] if cases else None


def caution(selection: Selection) -> str:
    """Where levels of loads at rest and of loads that move stand side by side, which the model has ranked wrongly; else ''."""
    cases = [*layout.ordinary(selection), *layout.added_references(selection)]
    levels = [c for c in cases if not math.isnan(c.value("felt_path_dB", math.nan)) and c.setting("load", "modulation", "trajectory", default=[])]
    if len({is_at_rest(c) for c in levels}) < 2:
        return ""
    return f"The model fails where the level compares loads at rest with loads that move, or LM with AM: see {STUDIES}."
