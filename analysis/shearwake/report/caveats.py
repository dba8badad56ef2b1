# SPDX-License-Identifier: BSD-3-Clause
"""What limits a result: numerical errors, cases without a result, and readings that are not valid."""
from __future__ import annotations

import math

from . import layout, warnings_of
from .answer import column, quantity
from .load import Selection
from .numerical_error import (estimated_at, is_measurement, numerical_variants, relative_error, settings_that_differ, spread_of,
                              sweeps_numbers_only, valid)
from .places import capital
from .ranking import Ranking
from .warnings_of import RATE
from .words import counted, number

ETA = "eta_period_1"


def is_incomplete(selection: Selection) -> bool:
    return bool(layout.axes(selection)) and any(not c.is_complete for c in selection.cases)


def estimate(selection: Selection, ranking: Ranking) -> list[str]:
    """The numerical error of the best case, or the uncertainty of a measurement, and the difference between engines."""
    best = ranking.best or (ranking.cases[0] if ranking.cases else None)
    if best is None:
        return []
    of, variants = ranking.quantity, numerical_variants(selection, best, ranking.quantity.column)
    text = []
    if len(variants) > 1 and not sweeps_numbers_only(selection):
        who = settings_that_differ(variants)
        text = [f"{capital(who)} differ by {number(100 * spread_of(variants, of.column)[1], 2)}\u00a0% in {of.name} there."]
    relative = relative_error(selection, best, of.column)[0]
    if is_measurement(selection):
        return [*text, "The uncertainty is unknown: measure with --repetitions." if math.isnan(relative) else
                f"Noise and gaps of the scan cause an uncertainty of {of.name} of {number(100 * relative, 2)}\u00a0%."]
    if math.isnan(relative):
        return [*text, "Numerical error not estimated: run shearwake converge."]
    return [*text, f"The numerical error of {of.name} is {number(100 * relative, 2)}\u00a0% of its value{estimated_at(selection, best, of.column)}."]


def caveats(selection: Selection, is_used: bool = False) -> list[str]:
    """Cases without a result, and readings that are not valid, which are used in the tables of the optima."""
    complete = [c for c in selection.cases if c.is_complete]
    missing, invalid = len(selection.cases) - len(complete), [c for c in complete if not warnings_of.is_valid(c)]
    found = []
    if missing and not is_incomplete(selection):
        found.append(f"{counted(missing, 'case')} of {len(selection.cases)} {'has' if missing == 1 else 'have'} no result.")
    if invalid and any(map(warnings_of.is_valid, layout.ordinary(selection))) | (column(selection).endswith(RATE) or is_used):
        among = layout.references_among(invalid)
        are = "is" if len(invalid) == 1 else "are"
        found.append(f"{len(invalid)} of {counted(len(complete), 'complete case')} {are} not valid{'' if is_used else f' and {are} not used'}"
                     f"{f' ({among})' if among else ''}: {warnings_of.reasons(invalid)}.")
    ordinary = [c for c in layout.ordinary(selection) if warnings_of.is_valid(c)]
    answer = column(selection)
    for name, what in {answer: f"value of {quantity(selection, answer).name}", ETA: "mean over complete periods"}.items():
        without = [c for c in ordinary if math.isnan(c.value(name, math.nan))]
        if 0 < len(without) < len(ordinary):
            found.append(f"{counted(len(without), 'case')} {'has' if len(without) == 1 else 'have'} no {what} and cannot be compared.")
    if alone := [c for c in valid(selection, ETA) if (r := selection.reference_of(c)) and r is not c and not warnings_of.is_valid(r)]:
        found.append(f"No ratio is stated for {counted(len(alone), 'valid case')}, because the readings of the reference are not valid.")
    return found
