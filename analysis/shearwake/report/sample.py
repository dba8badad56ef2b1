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


def column_words(selection: Selection, column: str) -> str:
    """A column of the table in words."""
    known = {"eta_period_1": "the efficiency η", "eta_at_1": "the efficiency η at the instant",
             "focal_rms_um": "the focal rms in µm", "peak_um": "the largest displacement in µm",
             "ipr_abs_period_mm2": "the spread in mm²", "participation_period_mm2": "the area that vibrates in mm²"}
    if column in known:
        return known[column]
    found = next((c for c in selection.sweep.columns if c.name == column), None)
    if found and found.over_reference_of in known:
        return f"the ratio of {known[found.over_reference_of]} to that of {layout.reference_name(layout.all_references(selection))}".replace(" in µm", "")
    return found.meaning if found else column


def best(selection: Selection) -> Any:
    """The column of the summary, the swept values with its highest median, and the statistics there; None without values."""
    rows = read_statistics(selection.sweep.folder, selection.sweep.name)
    column = next((c for c in RESULT if by_place(selection, rows, c)), None)
    if column is None:
        return None
    return column, *max(by_place(selection, rows, column).items(), key=lambda item: item[1]["q50"]["value"])


def likeliest(selection: Selection, rows: Any, threshold: str, value: float) -> Any:
    """The swept values at which a column exceeds a threshold with the largest probability, and the row of this probability; None
    without one."""
    name = f"exceeds {value:.9g}"
    ranked = [(s[name]["value"], w, s[name]) for w, s in by_place(selection, rows, threshold).items() if name in s]
    return max(ranked, key=lambda item: item[0])[1:] if ranked else None


def exceedances(selection: Selection, rows: Any) -> list[str]:
    """A sentence for each threshold of [uncertain] exceedance, for the swept values with the largest probability."""
    found = []
    for threshold, value in selection.sweep.uncertain["exceedance"].items():
        if likely := likeliest(selection, rows, threshold, value):
            where, row = likely
            name, at = column_words(selection, threshold), label(selection, where)
            found.append(f"{name[:1].upper()}{name[1:]} exceeds {number(value)} with a probability of {number(row['value'], 3)} (95 % "
                         f"confidence interval {number(row['low_95'], 3)} to {number(row['high_95'], 3)}"
                         f"{'; ' + row['note'] if row['note'] else ''}){', at ' + at if at else ''}.")
    return found


def sentence(selection: Selection) -> str:
    """The result in sentences, for the top of the page: the probabilities that the job asks for, then the median."""
    rows = read_statistics(selection.sweep.folder, selection.sweep.name)
    highest = best(selection)
    if highest is None:
        return "No sample has a value yet, so there is nothing to summarise."
    column, where, of_best = highest
    at = label(selection, where) if len(by_place(selection, rows, column)) > 1 else ""
    used, without = int(of_best["q50"]["samples"]), int(of_best["q50"]["without_value"])
    doubts = [note for q in ("q50", "q05", "q95") if (note := of_best[q]["note"])][:1]
    added = "; ".join([*([f"{at}, the highest median of the sweep"] if at else []), *doubts])
    median = (f"Over {counted(used, 'sample') if not without else f'{used} of {used + without} samples (the others are not valid or have no value)'} of "
              f"{counted(len(selection.sweep.uncertain['keys']), 'uncertain key')}, {column_words(selection, column)} has the median "
              f"{number(of_best['q50']['value'], 3)}; 90 % of the samples are between {number(of_best['q05']['value'], 3)} and "
              f"{number(of_best['q95']['value'], 3)}{f' ({added})' if added else ''}.")
    return " ".join([*exceedances(selection, rows), median])
