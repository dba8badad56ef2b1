# SPDX-License-Identifier: BSD-3-Clause
"""Curves in small multiples, for sweeps of too many keys for one panel."""
from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ...case import Case
from .. import answer, labels, layout, style, validity, warnings_of
from ..figure import Figure
from ..load import Selection
from ..page.curve_chart import draw_errors, error_caption
from ..words import listed, some_of
from . import fig_curves

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


def draw_references(axes: Axes, selection: Selection, cases: list[Case], column: str, name: str) -> None:
    """Draws the valid references of the cases of a line in grey behind it."""
    pairs = [(layout.x_position(selection, c), r.value(column, math.nan)) for c in cases
             if (r := selection.added_reference_of(c)) and warnings_of.is_valid(r, name)]
    if pairs:
        axes.plot(*zip(*pairs), color="#b0b0b0", linewidth=2.2, zorder=1)


def curve_figure(selection: Selection, measure: Any, plan: Any) -> Any:
    column, title = measure
    name, (colour, others) = "multiples_" + column, plan
    every = curves(selection, colour, others)
    shown = chosen(selection, every, others)
    if not any(math.isfinite(c.value(column, math.nan)) for c in layout.ordinary(selection)):
        return None
    values = layout.evenly(layout.values_of(selection, colour), style.CURVES)
    ordered = all(map(layout.is_number, values))
    colours = ([style.sequential(i / max(1, len(values) - 1)) for i in range(len(values))]
               if ordered else style.distinct(len(values)))
    columns = 2 if len(shown) == 4 else min(COLUMNS, len(shown))
    figure, made = style.panels(len(shown), columns, 1.75, 1.3, sharex=True, sharey=True)
    for axes, (panel, lines) in zip(made.flat, shown):
        for value, line in zip(values, colours):
            cases = lines.get(value, [])
            draw_references(axes, selection, cases, column, name)
            x = [layout.x_position(selection, c) for c in cases]
            y, invalid = validity.split(selection, cases, column, name, [c.value(column, math.nan) for c in cases])
            axes.plot(x, y, color=line, linewidth=1.3, marker="o", markersize=2.5)
            draw_errors(axes, np.array(x), y, cases, column, line)
            axes.plot(x, invalid, **{**validity.CROSSES, "markersize": 4, "markeredgewidth": 1.0})
        settings = ", ".join(layout.setting_text(selection, k, v) for k, v in zip(others, panel))
        axes.set_title(layout.wrapped(settings, 6.6 / columns), loc="left", fontsize=9)
    for i in range(len(shown)):
        made.flat[i].tick_params(labelbottom=i + columns >= len(shown))
    if layout.is_numeric(selection):
        if layout.is_logarithmic(layout.x_values(selection)):
            made[0, 0].set_xscale("log")
    else:
        fig_curves.set_x_axis(made[0, 0], selection)
        made[0, 0].set_xlabel("")
    figure.supxlabel(labels.axis_label(selection, selection.x), fontsize=9.5)
    figure.supylabel(answer.column_label(selection, column), fontsize=9.5)
    handles = [plt.Line2D([], [], color=c, marker="o", markersize=3, label=layout.setting_text(selection, colour, v))
               for v, c in zip(values, colours)]
    if layout.added_references(selection):
        handles.append(plt.Line2D([], [], color="#b0b0b0", linewidth=2.2, label=layout.reference_name(layout.all_references(selection))))
    style.legend_strip(figure, handles)
    head = f"{title} against {labels.name(selection, selection.x)}"
    text = (f"One panel per {listed(labels.name(selection, k) for k in others)} and one colour per "
            f"{labels.name(selection, colour)}; means over periods, with the same axes in all panels.")
    if layout.added_references(selection):
        text += f" Grey: {layout.reference_name(layout.all_references(selection))}."
    if len(shown) < len(every):
        text += f" {some_of(len(shown), len(every), 'panel')}, spread evenly."
    if len(values) < len(layout.values_of(selection, colour)):
        text += f" {some_of(len(values), len(layout.values_of(selection, colour)), 'value')}."
    return Figure(figure, name, head, text + error_caption(selection, column) + validity.invalid_caption(selection, name, column), head + ", one line per value")


def figures(selection: Selection) -> list[Any]:
    plan = split(selection)
    if plan is None or len(layout.groups(selection)) <= style.CURVES:
        return []
    return [f for m in MEASURES if (f := curve_figure(selection, m, plan))]
