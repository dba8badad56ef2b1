# SPDX-License-Identifier: BSD-3-Clause
"""Figures of adaptive axes: the points of each curve, its estimated error between them, and what was found."""
from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ...case import Case
from ...tables import read_adaptive
from .. import labels, layout, style
from ..figure import Figure
from ..load import Selection
from ..warnings_of import is_valid
from ..words import counted, number
from . import fig_heat

GOALS = {"maximum": "maxima", "minimum": "minima", "crossing": "crossings"}


def settings_text(case: Case, key: str) -> str:
    """The other settings of a case, as in the column `settings`."""
    def cell(value: Any) -> Any:
        return f"{value:.9g}" if isinstance(value, float) else str(value)
    return ", ".join(f"{k} = {cell(float(v) if isinstance(v, int) else v)}" for k, v in case.settings.items() if k != key)


def curves(selection: Selection, key: str, column: str) -> Any:
    """{settings: (x, y, label)} of the valid cases in ascending order."""
    found: dict[str, list[Any]] = {}
    for case in layout.ordinary(selection):
        if key in case.settings and is_valid(case) and not math.isnan(case.value(column, math.nan)):
            found.setdefault(settings_text(case, key), []).append((float(case.settings[key]), case.value(column, math.nan), case))
    made = {}
    for settings, points in found.items():
        points.sort(key=lambda p: p[0])
        others = [layout.setting_text(selection, k, v) for k, v in points[0][2].settings.items() if k != key]
        made[settings] = ([p[0] for p in points], [p[1] for p in points], ", ".join(others))
    return made


def draw_axis(axes: Axes, selection: Selection, axis: Any, rows: Any) -> Any:
    key, column = axis["key"], axis["column"]
    made = curves(selection, key, column)
    named = {row["settings"] for row in rows}
    shown = layout.evenly([s for s in made if s in named] or list(made), style.CURVES)
    for colour, settings in zip(style.distinct(len(shown)), shown):
        x, y, label = made[settings]
        axes.plot(x, y, color=colour, marker="o", markersize=3, linewidth=1, label=label or None)
        for row in (r for r in rows if r["settings"] == settings):
            if math.isnan(row["location"]):
                ends = np.array([row["from"], row["to"]])
                middle = np.interp(ends, x, y)
                axes.fill_between(ends, middle - row["estimated_error"], middle + row["estimated_error"], color=colour,
                                  alpha=0.3, linewidth=0)
            else:
                axes.axvline(row["location"], color=colour, linestyle="--", linewidth=1)
    if any(not math.isnan(row["location"]) for row in rows):
        axes.plot([], [], color=style.INK, linestyle="--", linewidth=1, label=f"{axis['goal']} found")
    if axis["goal"] == "crossing" and "level" in axis:
        axes.axhline(axis["level"], color=style.GREY, linewidth=0.8, label=f"level {number(axis['level'])}")
    elif axis["goal"] == "crossing":
        crossed = sorted((case.settings[key], reference.value(column, math.nan)) for case in layout.ordinary(selection)
                         if key in case.settings and (reference := selection.reference_of(case)) and is_valid(reference))
        axes.plot([x for x, _ in crossed], [y for _, y in crossed], ".", color=style.GREY, markersize=3, label="reference")
    axes.set_xlabel(labels.axis_label(selection, key))
    axes.set_ylabel(fig_heat.measure_label(selection, column))
    if axes.get_legend_handles_labels()[1] and len(shown) <= style.DIRECT_LABELS:
        axes.legend()
    return len(shown), len(made)


def sentence(selection: Selection, axis: Any, rows: Any) -> str:
    """What is known about an axis."""
    name = labels.name(selection, axis["key"])
    if not rows:
        return f" {name}: no curve has values."
    if axis["goal"] == "refine":
        errors = [row["estimated_error"] for row in rows if not math.isnan(row["estimated_error"])]
        wide = sum(row["within_tolerance"] == "no" for row in rows)
        text = (f" {name}: the estimated error of {axis['column']} between the points is at most "
                f"{number(max(errors), 2) if errors else 'unknown'} (tolerance {number(axis['tolerance'])}).")
        return text + (f" {counted(wide, 'interval')} {'exceeds' if wide == 1 else 'exceed'} the tolerance." if wide else "")
    places = [f"{number(row['location'], 6)} ± {number(max(row['location'] - row['from'], row['to'] - row['location']), 2)}"
              for row in rows]
    return f" {name}: {axis['goal'] if len(places) == 1 else GOALS[axis['goal']]} of {axis['column']} at {', '.join(places)}."


def figures(selection: Selection) -> Any:
    rows = read_adaptive(selection.sweep.folder, selection.sweep.name)
    if not selection.sweep.adaptive_axes or not rows:
        return []
    figure, made = style.panels(len(selection.sweep.adaptive_axes), 1, 2.9, 0.3)
    text = ("Points: the cases that the adaptive axes chose. Band: the estimated error of linear interpolation between "
            "them. Dashed: the extremum or the crossing.")
    for axes, axis in zip(made[:, 0], selection.sweep.adaptive_axes):
        mine = [row for row in rows if row["key"] == axis["key"]]
        shown, every = draw_axis(axes, selection, axis, mine)
        text += sentence(selection, axis, mine)
        if shown < every:
            text += f" The panel shows {shown} of {counted(every, 'curve')}; the table lists all."
    return [Figure(figure, "adaptive", "Adaptive axes", text, "Points, estimated error and extrema along the adaptive axes")]
