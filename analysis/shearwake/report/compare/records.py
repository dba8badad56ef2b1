# SPDX-License-Identifier: BSD-3-Clause
"""Which records of two cases differ by more than their tolerance: surfaces and traces.

The change of a record is its largest difference relative to its largest value of the second case. A record that one case lacks,
or has at other times or places, differs whatever its values are."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...case import Case
from .. import load
from .compare_tables import Comparison, text_cell
from .tolerances import Tolerances

SINGLE_PRECISION = 1e-6  # of stored fields


def incomplete(noun: str, first: int, second: int, common: int) -> str:
    """Why a record differs if it is not complete on both sides: 'recorded at 3 and 2 times, of which 2 are common'."""
    return "" if first == second == common else f"recorded at {first} and {second} {noun}, of which {common} are common"


def record_cell(entries: list[dict[str, Any]], keys: tuple[str, str], tolerance: float, reason: str) -> dict[str, Any] | None:
    """The difference of a record beyond its tolerance. `keys` name the largest difference and the largest value."""
    largest, peak = (float(np.max([entry[key] for entry in entries])) if entries else math.nan for key in keys)
    allowed = tolerance * peak
    if not reason and largest <= allowed:
        return None
    change = largest / peak if peak > 0.0 else math.nan
    over = largest / allowed if not reason and allowed > 0.0 and math.isfinite(largest) else math.inf
    parts = [f"{100.0 * change:.3g} % of its largest value"] if math.isfinite(change) else []
    parts += [f"{over:.2g} times its tolerance ({tolerance:g})"] if math.isfinite(over) else []
    return {"now": "", "reference": "", "change": change, "over_tolerance": over, "words": reason or ", ".join(parts) or "other"}


def reasons_of(a: Case, b: Case, pair: dict[str, Any]) -> dict[str, tuple[list[dict[str, Any]], tuple[str, str], str]]:
    """The records that a case has: their entries, the keys of these, and why they differ whatever their values are."""
    found: dict[str, tuple[list[dict[str, Any]], tuple[str, str], str]] = {}
    um = ("largest_um", "peak_um")
    times = [len(load.surface_times(case)) for case in (a, b)]
    if any(times):
        found["surface"] = (pair["fields"], um, incomplete("times", times[0], times[1], len(pair["fields"])))
    points = [len(load.traces(case)) for case in (a, b)]
    if any(points):
        entries, times = pair["traces"], [len(case.over_time["time"]) for case in (a, b)]
        common = entries[0]["times"] if entries else 0
        found["traces"] = (entries, um, incomplete("points", points[0], points[1], len(entries))
                           or incomplete("times", times[0], times[1], common))
    return found


def compare_records(a: Case, b: Case, pair: dict[str, Any], case: str, tolerances: Tolerances, found: Comparison) -> None:
    """Adds the differences of the records of two cases."""
    first, second = (", ".join(f"{z:.6g}" for z in depths) + " mm" for depths in pair["depths_mm"])
    if first != second:
        found.add("measured depths", 0.0, case, text_cell(first, second))
    for name, (entries, keys, reason) in reasons_of(a, b, pair).items():
        if not tolerances.ignores(name):
            tolerance = tolerances.for_column(name, SINGLE_PRECISION)
            found.add(name, tolerance, case, record_cell(entries, keys, tolerance, reason))
        elif name not in found.not_compared:
            found.not_compared.append(name)
