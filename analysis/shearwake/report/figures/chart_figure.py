# SPDX-License-Identifier: BSD-3-Clause
"""Draws charts with Matplotlib, as charts.js draws them in the browser."""
from __future__ import annotations

import math
import textwrap
from collections.abc import Sequence
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter, NullLocator

from .. import layout, style
from ..page.chart import Chart, Line
from ..validity import CROSSES
from ..words import number

LEAST_HEIGHT = 0.02  # of the y axis, relative to its middle: a flat curve would otherwise show only rounding errors
LETTERS = 13  # of a label per inch


def look(line: Line, marker: str) -> dict[str, Any]:
    """How a line is drawn; its marker distinguishes it in addition to its colour."""
    if line.crossed:
        return CROSSES
    found = {"color": line.colour, "label": line.label, "linestyle": "none" if line.dots else "--" if line.dashed else "-"}
    if line.points:
        return {**found, "marker": marker, "markersize": 5, "clip_on": False}
    return {**found, "marker": "o" if line.dots else "", "markersize": 3, "linewidth": 1.1}


def markers(charts: Sequence[Chart]) -> dict[str, str]:
    """The marker of each line by its label."""
    names = dict.fromkeys(line.label for chart in charts for line in chart.lines)
    return {name: style.MARKERS[n % len(style.MARKERS)] for n, name in enumerate(names)}


def legend_handles(charts: Sequence[Chart]) -> list[Line2D]:
    """One entry per name of a line. The caption explains crosses."""
    found: dict[str, Line2D] = {}
    marker = markers(charts)
    for line in (line for chart in charts for line in chart.lines if not line.crossed):
        found.setdefault(line.label, Line2D([], [], **look(line, marker[line.label])))
    return list(found.values())


def set_x_axis(axes: Axes, chart: Chart) -> None:
    """Puts ticks at the points of the lines if they fit; strings become labels."""
    if chart.x_names is not None:
        few = len(chart.x_names) <= 6
        axes.set_xticks(range(len(chart.x_names)), list(map(style.plain, chart.x_names)), rotation=0 if few else 30, ha="center" if few else "right")
        axes.set_xlim(-0.5, len(chart.x_names) - 0.5)
        axes.grid(False, axis="x")
        return
    marked = sorted({float(x) for line in chart.lines if line.points for x in line.x})
    if not marked:
        ends = np.concatenate([np.asarray(line.x, float) for line in chart.lines])
        axes.set_xlim(np.min(ends, initial=0.0), np.max(ends, initial=0.0) or 1.0)
        return
    if chart.x_log:
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(style.PlainFormatter())
    places = np.log(marked) if chart.x_log else np.array(marked)
    room = np.ptp(places) or max(1.0, abs(places[0]))
    ends = np.array([places[0] - 0.045 * room, places[-1] + 0.045 * room])
    axes.set_xlim(*(np.exp(ends) if chart.x_log else ends))
    if len(marked) <= 12 and (len(marked) < 2 or np.min(np.diff(places)) > 0.055 * room):
        texts = [number(value, 6) for value in marked]
        short = [number(value, 3) for value in marked]  # where labels would touch, if these still distinguish the values
        axes.set_xticks(marked, short if sum(map(len, texts)) > 60 and len(set(short)) == len(marked) else texts)
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_minor_formatter(NullFormatter())


def set_y_axis(axes: Axes, chart: Chart) -> None:
    if chart.y_log:
        axes.set_yscale("log")
    if chart.y_limits:
        axes.set_ylim(*chart.y_limits)
    if chart.y_ticks and chart.y_limits:
        style.ratio_axis(axes.yaxis, chart.y_limits)
    low, high = axes.get_ylim()
    if not chart.y_log and high - low < LEAST_HEIGHT * abs(low + high) / 2:
        axes.set_ylim(np.array([1.0 - LEAST_HEIGHT / 2, 1.0 + LEAST_HEIGHT / 2]) * (low + high) / 2)
    axes.yaxis.get_offset_text().set_x(-0.1)  # next to the title


def draw(axes: Axes, chart: Chart, marker: dict[str, str]) -> None:
    """Draws a chart without the labels of its axes. `marker`: that of each line by its label."""
    for mark in chart.marks:
        if mark.kind == "band":
            axes.axvspan(mark.x, mark.end, color="#f1f1f1", zorder=0, linewidth=0)
        elif mark.kind == "line":
            axes.axvline(mark.x, color=style.INK, linewidth=0.8, linestyle=":", zorder=1)
        elif mark.kind == "tick":
            axes.plot([mark.x, mark.x], [0.0, 0.035], color=mark.colour, linewidth=2.0, clip_on=False, transform=axes.get_xaxis_transform())
        else:
            axes.plot(mark.x, mark.y, "o", color=mark.colour, markersize=5)
    for line in chart.lines:
        axes.plot(line.x, line.y, **look(line, marker[line.label]))
        if line.error is not None and (known := np.isfinite(line.error) & np.isfinite(line.y)).any():
            axes.errorbar(np.asarray(line.x)[known], np.asarray(line.y)[known], np.asarray(line.error)[known], fmt="none", ecolor=line.colour,
                          elinewidth=1.2, capsize=3.5, zorder=2.5)
    axes.margins(y=0.12)
    set_x_axis(axes, chart)
    set_y_axis(axes, chart)


def chart_figure(charts: Sequence[Chart], height_in: float = 2.1, columns: int = 1, handles: list[Any] | None = None, sharex: Any = True,
                 sharey: Any = False) -> Any:
    """A figure with one panel of this height per chart, row by row, and a legend above with one entry per name of a line, or with these
    handles."""
    figure, made = style.panels(len(charts), columns, height_in, 0.7, sharex=sharex, sharey=sharey)
    width_in = (style.width_in() - 1.0) / columns
    marker = markers(charts)
    for n, (axes, chart) in enumerate(zip(made.flat, charts)):
        draw(axes, chart, marker)
        axes.set_title(layout.wrapped(chart.title, width_in), loc="left", color="#555555", fontsize=9.5 if columns < 3 else 9)
        if n % columns == 0 or not sharey:
            axes.set_ylabel(textwrap.fill(chart.y_label, math.ceil(LETTERS * height_in), break_on_hyphens=False, break_long_words=False))
        is_last = n + columns >= len(charts) or not sharex
        axes.tick_params(labelbottom=is_last)
        if is_last:
            axes.set_xlabel(chart.x_label)
    figure.align_ylabels()
    handles = legend_handles(charts) if handles is None else handles
    if len(handles) > 1:
        style.legend_strip(figure, handles)
    return figure
