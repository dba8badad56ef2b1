# SPDX-License-Identifier: BSD-3-Clause
"""The statistics of a job with [uncertain], which `shearwake reduce` wrote."""
from __future__ import annotations

import math
from typing import Any

from ..tables import read_statistics
from . import layout
from .load import Selection
from .words import counted, number

RESULT = ("eta_period_1", "eta_at_1")  # the column of the summary: the first that has values


def swept(selection: Selection) -> Any:
    """The swept keys that are not uncertain."""
    return [key for key in selection.sweep.swept_keys if key not in selection.sweep.uncertain["keys"]]


def place(selection: Selection, row: Any) -> Any:
    """The swept values of a row or of the settings of a case, as in the CSV."""
    def cell(value: Any) -> Any:
        return value if isinstance(value, str) else f"{value:.9g}"
    return tuple(cell(row[key]) if key in row else "" for key in swept(selection))


def label(selection: Selection, where: Any, without: Any = "") -> str:
    """'AM frequency 200 Hz, focus FWHM 3 mm' for the swept values `where`."""
    parts = []
    for key, value in zip(swept(selection), where):
        if key != without and value != "":
            parts.append(layout.setting_text(selection, key, amount(value)))
    return ", ".join(parts)


def amount(value: Any) -> Any:
    try:
        return float(value)
    except ValueError:
        return value


def by_place(selection: Selection, rows: Any, column: str) -> Any:
    """{swept values: {statistic: row}} of a column."""
    found: dict[Any, dict[str, Any]] = {}
    for row in rows:
        if row["column"] == column and not math.isnan(row["value"]):
            found.setdefault(place(selection, row), {})[row["statistic"]] = row
    return found


def doubt(row: Any) -> Any:
    """The note of a statistic about its sample, as the continuation of a sentence; '' if the sample suffices."""
    return f" ({row['note']})" if row["note"] else ""


def sentence(selection: Selection) -> str:
    """The result in a sentence, for the top of the page."""
    rows = read_statistics(selection.sweep.folder, selection.sweep.name)
    column = next((c for c in RESULT if by_place(selection, rows, c)), None)
    if column is None:
        return "No sample has a value yet, so there is nothing to summarise."
    found = by_place(selection, rows, column)
    where, best = max(found.items(), key=lambda item: item[1]["q50"]["value"])
    at = label(selection, where)
    used, without = int(best["q50"]["samples"]), int(best["q50"]["without_value"])
    text = (f"Over {counted(used, 'sample') if not without else f'{used} of {used + without} samples (the others are not valid or have no value)'} of "
            f"{counted(len(selection.sweep.uncertain['keys']), 'uncertain key')}, the efficiency η ({column}) has the median "
            f"{number(best['q50']['value'], 3)}; 90 % of the samples are between {number(best['q05']['value'], 3)} and "
            f"{number(best['q95']['value'], 3)}")
    text += f" ({at}, the highest median of the sweep)" if at and len(found) > 1 else ""
    text += f"{doubt(best['q50']) or doubt(best['q05']) or doubt(best['q95'])}."
    for threshold, value in selection.sweep.uncertain["exceedance"].items():
        likely = by_place(selection, rows, threshold)
        name = f"exceeds {value:.9g}"
        ranked = [(s[name]["value"], w, s[name]) for w, s in likely.items() if name in s]
        if ranked:
            _, w, row = max(ranked, key=lambda item: item[0])
            at = label(selection, w)
            text += (f" {threshold} exceeds {number(value)} with a probability of {number(row['value'], 3)} (95 % "
                     f"confidence interval {number(row['low_95'], 3)} to {number(row['high_95'], 3)}"
                     f"{'; ' + row['note'] if row['note'] else ''}){', at ' + at if at else ''}.")
    return text
