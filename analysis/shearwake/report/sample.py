# SPDX-License-Identifier: BSD-3-Clause
"""The statistics of a job with [uncertain], which `shearwake reduce` wrote."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

from ..tables import read_statistics
from . import labels, layout
from .answer import NOTICEABLE_dB, Quantity, column, quantity
from .load import Selection
from .places import NAMED
from .ranking import comparable
from .words import counted, listed, number

RESULT = ("eta_period_1", "eta_at_1")  # the columns of the summary if that which answers the question has no values


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
    """A column of the table in words, with its unit."""
    of = quantity(selection, column)
    return of.name + (f" in {of.unit}" if of.unit not in ("", "%") else "")


def placed(selection: Selection, where: Any) -> str:
    """' with SM-STM at AM frequency 200 Hz' for the swept values `where`; '' without swept keys."""
    settings = {key: amount(value) for key, value in zip(swept(selection), where) if value != ""}
    keys = [key for key in layout.axes(selection) if key in settings]
    return labels.placed(selection, settings, keys, labels.place_text(selection, settings, keys))


@dataclass
class Median:
    """The medians of a column at each place. `alike`: the places whose median does not differ from the highest one, for `reason`;
    `groups` counts those that may be compared."""
    quantity: Quantity
    rows: dict[Any, dict[str, Any]]
    highest: Any
    alike: list[Any]
    reason: str
    difference: str  # why places are not ranked

    @property
    def range(self) -> str:
        values = [rows["q50"]["value"] for rows in self.rows.values()]
        return self.quantity.range(min(values), max(values))

    @property
    def is_highest(self) -> bool:
        return len(self.rows) > 1 and not self.alike and not self.difference


def median(selection: Selection) -> Median | None:
    """The medians of the column that answers the question, or of the efficiency; None without values."""
    rows = read_statistics(selection.sweep.folder, selection.sweep.name)
    name = next((c for c in (column(selection), *RESULT) if by_place(selection, rows, c)), None)
    if name is None:
        return None
    found, of = by_place(selection, rows, name), quantity(selection, name)
    highest = max(found, key=lambda where: found[where]["q50"]["value"])
    best = found[highest]["q50"]
    others = [w for w in found if w != highest]
    overlap = [w for w in others if found[w]["q50"]["high_95"] >= best["low_95"]]
    near = [w for w in others if of.is_level and best["value"] - found[w]["q50"]["value"] < NOTICEABLE_dB]
    cases = {place(selection, c.settings): c for c in layout.ordinary(selection)}
    apart = comparable(name, [cases[w] for w in found if w in cases])[1] if len(found) > 1 else ""
    return Median(of, found, highest, overlap or near, "95 % confidence intervals overlap" if overlap else
                  f"people notice {NOTICEABLE_dB} dB", apart)


def likeliest(selection: Selection, rows: Any, threshold: str, value: float) -> Any:
    """The swept values at which a column exceeds a threshold with the largest probability, and the row of this probability; None
    without one."""
    ranked = probabilities(selection, rows, threshold, value)
    return max(ranked, key=lambda item: item[1]["value"]) if ranked else None


def probabilities(selection: Selection, rows: Any, threshold: str, value: float) -> list[tuple[Any, dict[str, Any]]]:
    name = f"exceeds {value:.9g}"
    return [(where, s[name]) for where, s in by_place(selection, rows, threshold).items() if name in s]


def exceedances(selection: Selection, rows: Any, apart: str) -> list[str]:
    """A sentence for each threshold of [uncertain] exceedance: the probability at each of a few places, or the largest one unless
    places are not comparable, for the reason `apart`."""
    found = []
    for threshold, value in selection.sweep.uncertain["exceedance"].items():
        every = probabilities(selection, rows, threshold, value)
        if not every:
            continue
        few = every if len(every) <= NAMED else [likeliest(selection, rows, threshold, value)]
        of = quantity(selection, threshold)
        if len(few) < len(every) and apart:
            low, high = (number(100 * f(row["value"] for _, row in every), 3) for f in (min, max))
            found.append(f"{of.title} exceeds {of.difference(value)} in {low} to {high}\u00a0% of the samples; {apart} are not ranked.")
            continue
        parts: list[str] = []
        notes = list(dict.fromkeys(row["note"] for _, row in few if row["note"]))
        for where, row in few:
            interval = f"{number(100 * row['low_95'], 2)} to {number(100 * row['high_95'], 2)}\u00a0%"
            parts.append(f"in {'at most ' if len(few) < len(every) else ''}{number(100 * row['value'], 3)}\u00a0%{'' if parts else ' of the samples'}"
                         f"{placed(selection, where)} ({interval if parts else f'95 % confidence interval of the probability {interval}'})")
        found.append(f"{of.title} exceeds {of.difference(value)} {listed(parts)}{f'; {notes[0]}' if notes else ''}.")
    return found


def medians(selection: Selection, found: Median) -> list[str]:
    """Where the median is highest, or why no place is called so."""
    of = found.quantity
    if len(found.rows) < 2:
        return []

    def named(where: Any) -> str:
        return f"{placed(selection, where).strip().removeprefix('with ').removeprefix('at ')} ({of.difference(found.rows[where]['q50']['value'])})"
    if found.is_highest:
        return [f"The median is highest{placed(selection, found.highest)}: {of.text(found.rows[found.highest]['q50']['value'])}."]
    alike = [found.highest, *found.alike]
    shown = [named(w) for w in alike] if len(alike) <= NAMED else [named(found.highest), f"{len(alike) - 1} further places"]
    return [f"No median of {of.name} is called the highest, because {found.reason}: {listed(shown)}."]


def sentences(selection: Selection) -> list[str]:
    """The probabilities that the job asks for, then the medians."""
    rows, found = read_statistics(selection.sweep.folder, selection.sweep.name), median(selection)
    if found is None:
        return ["No sample has a value yet, so there is nothing to summarise."]
    of, there = found.quantity, found.rows[found.highest]
    used, without = int(there["q50"]["samples"]), int(there["q50"].get("without_value") or 0)
    doubts = [note for q in ("q50", "q05", "q95") if (note := there[q]["note"])][:1]
    samples = counted(used, "sample") if not without else f"{used} of {used + without} samples (the others are not valid or have no value)"
    keys = counted(len(selection.sweep.uncertain["keys"]), "uncertain key")
    if found.difference:
        return [*exceedances(selection, rows, found.difference), f"Over {samples} of {keys}, the median of {of.name} is {found.range}; "
                f"{found.difference} are not ranked."]
    at = placed(selection, found.highest) if len(found.rows) > 1 else ""
    last = (f"Over {samples} of {keys}{at}, {of.name} has the median "
            f"{of.text(there['q50']['value'])}; 90 % of the samples are between {of.difference(there['q05']['value'])} and "
            f"{of.difference(there['q95']['value'])}{f' ({doubts[0]})' if doubts else ''}.")
    return [*exceedances(selection, rows, ""), *medians(selection, found), last]
