# SPDX-License-Identifier: BSD-3-Clause
"""The question of a job, the column that answers it, and how the values of a column read."""
from __future__ import annotations

import math
import re
from dataclasses import dataclass
from typing import Any

from .. import keys
from ..case import Case
from ..keys import job_tables
from . import layout
from .load import Selection, remembered
from .numerical_error import valid
from .warnings_of import RATE
from .words import number

LONGEST = 340  # characters of the question; the job file on the page has the rest of the comment
SENTENCE = re.compile(r"(?<=[.?!])\s+(?=[A-Z0-9])")
NOTICEABLE_dB = 2.3  # just noticeable difference of the level (src/measures/sensation.hpp)
FELT = re.compile(r"\b(felt|feels?|perceiv|perception|perceptible|sensation|strong)", re.IGNORECASE)
RECEPTORS = re.compile(r"\b(receptor|mechanoreceptor|afferent|spike|fire|firing|nerve)", re.IGNORECASE)


@dataclass(frozen=True)
class Quantity:
    """A column in words. `seeks_most`: whether a reader looks for its largest value, as for efficiencies, levels and rates."""
    column: str
    name: str
    unit: str
    seeks_most: bool

    @property
    def is_level(self) -> bool:
        return self.unit == "dB"

    @property
    def title(self) -> str:
        return self.name[:1].upper() + self.name[1:]

    def scaled(self, value: float) -> float:
        return 100.0 * value if self.unit == "%" else value

    def difference(self, value: float) -> str:
        """A level with one decimal, since 2.3 dB are just noticeable, and any other value with three digits."""
        shown = number(round(value, 1), 4) if self.is_level else number(self.scaled(value), 3)
        return f"{shown}\u00a0{self.unit}" if self.unit else shown

    def range(self, low: float, high: float) -> str:
        """'20 to 40 %', or one value if both read the same."""
        ends = self.difference(low), self.difference(high)
        return ends[0] if ends[0] == ends[1] else f"{ends[0].removesuffix(chr(160) + self.unit)} to {ends[1]}"

    def text(self, value: float, half: float = math.nan) -> str:
        """'62 %', '50.30 ± 0.50 %' with half the width of the interval of its error, '−3 dB, below the threshold of perception'."""
        if half > 0:
            places = min(6, max(0, 1 - math.floor(math.log10(self.scaled(half)))))
            return f"{self.scaled(value):.{places}f} ± {self.scaled(half):.{places}f}\u00a0{self.unit}".rstrip()
        return self.difference(value) + (", below the threshold of perception" if self.is_level and value < 0 else "")


def quantity(selection: Selection, column: str) -> Quantity:
    """A column of the table in words and with its unit."""
    found = next((c for c in selection.sweep.columns if c.name == column), None)
    if found and found.over_reference_of:
        of = quantity(selection, found.over_reference_of)
        return Quantity(column, f"the ratio of {of.name} to that of {reference_name(selection)}", "", of.seeks_most)
    if column.endswith(RATE):
        return Quantity(column, f"the {keys.label(column)} together", "spikes/s", True)
    unit = "%" if column.startswith("eta_") else keys.shown_unit(column)
    return Quantity(column, f"the {keys.label(column)}", unit, column.startswith("eta_") or column in ("felt_path_dB", "felt_peak_dB"))


def column_label(selection: Selection, column: str) -> str:
    """The label of a column with its unit, in which the kind of the reference stands for it: 'focal rms relative to plain STM'."""
    return keys.axis_label(column).replace("the reference", layout.reference_name(layout.all_references(selection)))


def reference_name(selection: Selection) -> str:
    """'plain STM', or 'STM' if a case of the sweep is the reference of the others."""
    found = layout.all_references(selection)
    name = layout.reference_name(found)
    return name if not found or any(r.is_reference for r in found) else name.removeprefix("plain ").removeprefix("reference ")


def _table(selection: Selection) -> dict[str, Any]:
    """The table [job] of the job file."""
    found = job_tables(selection.sweep.job_text).get("job", {})
    return found if isinstance(found, dict) else {}


def question(selection: Selection) -> str:
    """job.question, or else the first sentences of the comment at the beginning of the job file, to the first question."""
    if asked := str(_table(selection).get("question", "")):
        return asked
    lines = []
    for line in selection.sweep.job_text.splitlines():
        if not line.startswith("#"):
            break
        lines.append(line.lstrip("#").strip())
    words = " ".join(line for line in lines if not line.startswith(("SPDX-", ":schema")))
    text = ""
    for part in SENTENCE.split(words):
        if text and len(text) + len(part) >= LONGEST:
            break
        text += (" " if text else "") + part
        if part.endswith("?"):
            break
    text = text.replace("`", "")
    return text if len(text) <= LONGEST or text.endswith("?") else text[:LONGEST].rpartition(" ")[0] + " …"


def is_at_rest(case: Case) -> bool:
    """Whether the foci of a case do not move."""
    return all(move.get("mover") == "hold" for move in case.setting("load", "modulation", "trajectory", default=[{}]))


def firing(selection: Selection) -> str:
    """The rate of the class of receptors that fires most; '' if there are none or if they are silent."""
    rates = {name + RATE: max((c.value(name + RATE) for c in valid(selection, name + RATE)), default=0.0)
             for name in layout.receptor_classes(selection)}
    most = max(rates, key=lambda column: rates[column], default="")
    return most if rates.get(most) else ""


def asks_for_receptors(selection: Selection) -> bool:
    return bool(RECEPTORS.search(f"{selection.sweep.title} {question(selection)}"))


@remembered
def column(selection: Selection) -> str:
    """The column that answers the question: job.answer; else the column that the job searches or whose exceedance it asks for; else
    what the title and the question ask for, a level of sensation or receptors; else the efficiency."""
    known = {c.name for c in selection.sweep.columns}
    searched = [axis["column"] for axis in selection.sweep.adaptive_axes if axis["goal"] != "refine"]
    exceeded = list(selection.sweep.uncertain.get("exceedance", {})) if selection.sweep.uncertain else []
    for named in [_table(selection).get("answer"), *searched, *exceeded]:
        if named in known:
            return str(named)
    asked = f"{selection.sweep.title} {question(selection)}"
    level = "felt_peak_dB" if all(map(is_at_rest, layout.ordinary(selection))) else "felt_path_dB"
    if FELT.search(asked) and level in known:
        return level
    if asks_for_receptors(selection) and firing(selection):
        return firing(selection)
    return "eta_period_1" if valid(selection, "eta_period_1") else firing(selection) or "eta_period_1"
