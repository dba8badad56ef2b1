# SPDX-License-Identifier: BSD-3-Clause
"""Chooses the cases of figures with one panel per case, with their references."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ..case import Case
from . import layout
from .load import Selection


def of_cases(selection: Selection, cases: list[Case]) -> list[Case]:
    """The distinct references of the cases, each once, in the order of the cases."""
    found = {r.id: r for c in cases if (r := selection.reference_of(c)) and r is not c}
    return layout.motions(found.values())


def with_references(selection: Selection, cases: list[Case], most: int) -> list[Case]:
    """At most `most` of the cases and their references. References that depend on a swept key precede their
    cases, so that each value appears with its own reference; a common reference comes first."""
    cases = list(cases)
    if len(of_cases(selection, cases)) > 1:
        cases = layout.evenly(cases, max(1, most // 2))
    else:
        cases = layout.evenly(cases, most - len(of_cases(selection, cases)))
    own = of_cases(selection, cases)
    ordered: dict[str, Case] = {}
    for case in cases:
        reference = selection.reference_of(case)
        same = [r for r in own if reference and layout.have_same_motion(r, reference)]
        for one in [*same, case]:
            ordered.setdefault(one.id, one)
    return list(ordered.values())


def first_and_last(selection: Selection, most: int) -> list[Case]:
    """Cases from the first to the last curve with their references, at most `most`."""
    picks = [c for g in layout.evenly(layout.groups(selection), 2) for c in layout.evenly(g.cases, most - 1)]
    return with_references(selection, picks, most)


def columns_of(selection: Selection, groups: list[layout.Group], chosen: Callable[..., Any]) -> list[list[Any]]:
    """The columns of a figure with one column per curve, top to bottom; `chosen(cases)` selects the cases of a
    curve. A single reference is on top of its curve; a reference that several curves share is on top of the first of
    them only. References that differ within a curve form a column of their own, next to their cases, which curves
    with the same references share."""
    columns: list[Any] = []
    shown: list[Case] = []
    on_top: list[Case] = []
    for group in groups:
        cases = chosen(group.cases)
        own = of_cases(selection, group.cases)
        if len(own) > 1:
            beside = of_cases(selection, cases)
            if not (len(beside) == len(shown) and all(map(layout.have_same_motion, beside, shown))):
                columns.append(beside)
            shown = beside
            columns.append(cases)
        elif own:
            is_drawn = any(layout.have_same_motion(own[0], r) for r in on_top)
            columns.append(([None] if is_drawn else own) + cases)
            on_top += own
        else:
            columns.append(cases)
    return columns
