# SPDX-License-Identifier: BSD-3-Clause
"""The warnings that are stored with the cases, the figures that they concern, and the readings that they invalidate.

`kinds(selection)` lists the warnings of its cases, `of_figure(selection, name, ids)` those of the cases that a figure shows.
"""
from __future__ import annotations

import functools
import re
import textwrap
from dataclasses import dataclass
from typing import Any

from ..case import Case
from . import layout
from .load import Selection, remembered
from .page import topics

OF_DRIVE = ("drive",)  # shows the prescribed load alone
OF_MEDIA = ("medium",)  # shows the medium alone
OF_SURFACES = ("surface", "intensity", "player", "profiles", "volume")  # show fields, not readings
OF_READINGS, OF_RECEPTORS = "eta", "afferents"  # figures that stand for all readings of the surface, and of receptors
RATE = "_total_rate_Hz"  # end of the columns with the firing rate of a class of receptors
CONCLUSION = re.compile(": the readings( of this case)? are not valid$")
CLAUSE = re.compile(r"[,;:.] ")
NUMBER = re.compile(r"[0-9]+(?:\.[0-9]+)?(?:e[-+]?[0-9]+)?")


@dataclass
class Kind:
    """Warnings of one or more cases that differ only in their numbers."""
    number: int  # position in the list of the page, from 1
    severity: str
    key: str
    message: str  # with the range of every number
    cases: list

    @property
    def is_error(self) -> bool:
        return self.severity == "error"

    def name(self) -> str:
        """What is wrong, in a few words: the first clause of the message."""
        clause = textwrap.shorten(CLAUSE.split(self.message)[0], 100, placeholder=" …")
        return f"not valid: {clause}" if self.is_error else clause


@functools.cache
def is_of_receptors(name: str) -> bool:
    """Whether a figure belongs to the topic of the receptors, which has all figures that belong to no other."""
    return name != "player" and topics.topic_of(name) == topics.TOPICS[-1][0]


@functools.cache
def may_concern(key: str, name: str) -> bool:
    """Whether a warning about this key may concern the figure of this name, depending on the case."""
    if key.startswith("afferents."):
        return is_of_receptors(name)
    if name.startswith(OF_DRIVE):
        return False
    if name.startswith(OF_MEDIA):
        return key.startswith("medium.")
    if key.startswith("measure."):  # at_ms is also the default time of the snapshots
        return not is_of_receptors(name) and (key == "measure.at_ms" or not name.startswith(OF_SURFACES))
    return True


def concerns(case: Case, key: str, name: str) -> bool:
    """Whether a warning about this key of a case concerns the figure of this name. Pins that move as prescribed do so independently of
    the simulated skin."""
    if not may_concern(key, name):
        return False
    return key.startswith("afferents.") or not is_of_receptors(name) or case.setting("afferents", "input", default="") != "carrier"


def errors(case: Case, name: str) -> list[dict[str, str]]:
    """The warnings of a case which state that what a figure shows is not valid."""
    return [w for w in case.warnings if w["severity"] == "error" and concerns(case, w["key"], name)]


def figure_of(column: str) -> str:
    """The name of the figures whose validity a column shares."""
    return OF_RECEPTORS if column.endswith(RATE) else OF_READINGS


def is_valid(case: Case, name: str = OF_READINGS) -> bool:
    return not errors(case, name)


def is_valid_value(selection: Selection, case: Case, column: str, name: str = OF_READINGS) -> bool:
    """Whether the value of a column is valid: that of the case and, for a ratio, that of its reference."""
    if not is_valid(case, name):
        return False
    reference = selection.reference_of(case) if selection.is_ratio(column) else None
    return reference is None or is_valid(reference, name)


def label(selection: Selection, case: Case, name: str) -> str:
    """The label of a case in a figure; states if what the figure shows of it is not valid."""
    return layout.case_label(selection, case) + ("" if is_valid(case, name) else " (not valid)")


def template(warning: dict[str, str]) -> tuple[str, str, str]:
    """Equal for warnings that differ only in their numbers."""
    return warning["severity"], warning["key"], NUMBER.sub("#", warning["message"])


def merged(messages: list[str]) -> str:
    """Messages that differ only in their numbers as one message with the range of each number: 'at 4 to 5 ms'."""
    pieces = NUMBER.split(messages[0])
    text = pieces[0]
    for values, piece in zip(zip(*map(NUMBER.findall, messages)), pieces[1:]):
        low, high = min(values, key=float), max(values, key=float)
        text += (low if float(low) == float(high) else f"{low} to {high}") + piece
    return text if len(messages) == 1 else text.replace("the readings of this case are", "the readings are")


def kinds_of(cases: list[Case], name: str | None = None) -> list[Kind]:
    """The kinds of warnings of some cases that concern a figure, those of invalid readings first."""
    found: dict[Any, list[tuple[Case, str]]] = {}
    for case in cases:
        for warning in case.warnings:
            if name is None or concerns(case, warning["key"], name):
                found.setdefault(template(warning), []).append((case, warning["message"]))
    ordered = sorted(found.items(), key=lambda item: item[0][0] != "error")
    return [Kind(n + 1, severity, key, merged([m for _, m in entries]),
                 list({c.id: c for c, _ in entries}.values()))
            for n, ((severity, key, _), entries) in enumerate(ordered)]


@remembered
def kinds(selection: Selection) -> list[Kind]:
    """All kinds of warnings of the complete cases, references included, in the order of the list of the page."""
    return kinds_of([c for c in selection.cases if c.is_complete])


def of_figure(selection: Selection, name: str, ids: list[str] | None = None) -> list[Kind]:
    """The kinds of warnings that concern the figure `name`, with those cases that it shows (None: all complete cases)."""
    made, wanted = [], set(ids or [])
    for kind in kinds(selection):
        shown = [c for c in kind.cases if (ids is None or c.id in wanted) and concerns(c, kind.key, name)]
        if shown:
            made.append(Kind(kind.number, kind.severity, kind.key, kind.message, shown))
    return made


def reasons(cases: list[Case], name: str = OF_READINGS) -> str:
    """Why the readings of some cases are not valid, for a sentence that states that they are not: the last sentence of
    each message, which contains what was computed."""
    found = []
    for kind in kinds_of(cases, name):
        if kind.is_error:
            text = CONCLUSION.sub("", kind.message.split(". ")[-1])
            found.append(text[:1].lower() + text[1:])
    return "; ".join(dict.fromkeys(found))
