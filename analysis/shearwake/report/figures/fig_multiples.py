# SPDX-License-Identifier: BSD-3-Clause
"""Curves in small multiples, for sweeps of too many keys for one panel."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...case import Case
from .. import labels, layout, style, validity, warnings_of
from ..figure import Figure
from ..load import Selection
from ..page.chart import Line
from ..page.curve_chart import empty_chart, error_caption, errors, with_crosses
from ..words import listed, some_of
from .chart_figure import chart_figure

PANELS = 9
COLUMNS = 3
MEASURES = [("eta_period_1", "Reconstruction efficiency"), ("focal_rms_um", "Strength at the focus")]


def split(selection: Selection) -> tuple[str, list[str]] | None:
    """The key of the colours and the keys of the panels; None if there are too few keys. Of three keys, the one
    with the fewest values forms the rows and the one with the most the columns."""
    others = [k for k in layout.axes(selection) if k != selection.x]
    if len(others) < 2 or not selection.x:
        return None
    ordered = sorted(others, key=lambda k: len(layout.values_of(selection, k)))
    if len(ordered) == 3:
        return ordered[1], [ordered[0], ordered[2]]
    return ordered[0], [k for k in others if k != ordered[0]]


def chosen(selection: Selection, every: Any, others: Any) -> Any:
    """The panels to draw: for two keys complete rows with some of the columns, else some panels, spread
    evenly."""
    rows = layout.values_of(selection, others[0])
    if len(others) != 2 or len(rows) > 3:
        return layout.evenly(every, PANELS)
    some = layout.evenly(layout.values_of(selection, others[1]), COLUMNS)
    found = dict(every)
    return [(p, found[p]) for p in ((r, s) for r in rows for s in some) if p in found]


def curves(selection: Selection, colour: Any, others: Any) -> Any:
    """(values of the keys of the panel) -> value of the key of the colour -> cases in the order of x."""
    found: dict[Any, dict[Any, list[Case]]] = {}
    for case in layout.ordinary(selection):
        panel = tuple(case.settings.get(k, "") for k in others)
        found.setdefault(panel, {}).setdefault(case.settings.get(colour, ""), []).append(case)
    for lines in found.values():
        for cases in lines.values():
            cases.sort(key=lambda c: layout.x_position(selection, c))
    every = list(found.items())
    if all(layout.is_number(v) for panel, _ in every for v in panel):
        every.sort(key=lambda item: item[0])
    return every


def lines_of(selection: Selection, cases: list[Case], column: str, name: str, label: str, colour: Any) -> list[Line]:
    """A line with its crosses, and the valid references of its cases in grey behind it."""
    pairs = [(layout.x_position(selection, c), r.value(column, math.nan)) for c in cases
             if (r := selection.added_reference_of(c)) and warnings_of.is_valid(r, name)]
    reference = [Line(layout.reference_name(layout.all_references(selection)), [x for x, _ in pairs], [y for _, y in pairs], "#909090", dashed=True)]
    line = Line(label, [layout.x_position(selection, c) for c in cases], [], colour, error=errors(cases, column), points=True)
    return [*(reference if pairs else []), *with_crosses(line, validity.split(selection, cases, column, name, [c.value(column, math.nan) for c in cases]))]


def curve_figure(selection: Selection, measure: Any, plan: Any) -> Any:
    column, title = measure
    name, (colour, others) = "multiples_" + column, plan
    every = curves(selection, colour, others)
    shown = chosen(selection, every, others)
    if not any(math.isfinite(c.value(column, math.nan)) for c in layout.ordinary(selection)):
        return None
    values = layout.evenly(layout.values_of(selection, colour), style.CURVES)
    colours = ([style.sequential(f) for f in np.linspace(0.0, 1.0, len(values))] if all(map(layout.is_number, values))
               else style.distinct(len(values)))
    charts = []
    for panel, lines in shown:
        charts.append(empty_chart(selection, column, ", ".join(layout.setting_text(selection, k, v) for k, v in zip(others, panel))))
        for value, look in zip(values, colours):
            charts[-1].lines += lines_of(selection, lines.get(value, []), column, name, layout.setting_text(selection, colour, value), look)
    head = f"{title} against {labels.name(selection, selection.x)}"
    text = (f"One panel per {listed(labels.name(selection, k) for k in others)} and one colour per "
            f"{labels.name(selection, colour)}; means over periods, with the same axes in all panels.")
    if layout.added_references(selection):
        text += f" Grey: {layout.reference_name(layout.all_references(selection))}."
    if len(shown) < len(every):
        text += f" {some_of(len(shown), len(every), 'panel')}, spread evenly."
    if len(values) < len(layout.values_of(selection, colour)):
        text += f" {some_of(len(values), len(layout.values_of(selection, colour)), 'value')}."
    figure = chart_figure(charts, 1.75, 2 if len(shown) == 4 else min(COLUMNS, len(shown)), sharey=True)
    return Figure(figure, name, head, text + error_caption(selection, column) + validity.invalid_caption(selection, name, column), head + ", one line per value")


def figures(selection: Selection) -> list[Any]:
    plan = split(selection)
    if plan is None or len(layout.groups(selection)) <= style.CURVES:
        return []
    return [f for m in MEASURES if (f := curve_figure(selection, m, plan))]
