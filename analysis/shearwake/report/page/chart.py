# SPDX-License-Identifier: BSD-3-Clause
"""The data of an interactive figure: panels of lines that charts.js draws with uPlot."""
from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from matplotlib.colors import to_hex

MOST_POINTS = 600  # of a line; the pictures contain all points
DIGITS = 4         # significant digits of stored values


@dataclass
class Line:
    label: str
    x: Any  # numbers, as list or array
    y: Any
    colour: object
    case: str = ""      # id of the case, by which the table selects lines
    error: Any = None  # half the length of an error bar per point
    dashed: bool = False
    points: bool = False
    dots: bool = False     # points without a line: a spectrum that consists of lines
    crossed: bool = False  # crosses without a line: values that are not valid


@dataclass
class Mark:
    """Something that a panel shows in addition to its lines: "band" (grey from x to `end`), "line" (dotted, vertical),
    "tick" (short, on the x axis) or "dot" (at x, y)."""
    kind: str
    x: float
    end: float | None = None
    y: float | None = None
    colour: object = "#222222"
    case: str = ""  # id of the case with which it is hidden


@dataclass
class Chart:
    """One panel. Lines of one figure share the x axis, so that zooming one panel zooms all."""
    x_label: str
    y_label: str
    lines: list = field(default_factory=list)
    title: str = ""
    x_names: list | None = None  # of positions 0, 1, ... if x is a string
    x_log: bool = False
    y_log: bool = False
    y_limits: tuple[float, float] | None = None
    y_ticks: list | None = None  # of a logarithmic scale around 1; None: chosen by uPlot
    marks: list = field(default_factory=list)

    def begin_at_zero(self) -> None:
        """Limits the vertical axis to 0 and the largest value, unless a value is negative."""
        values = np.concatenate([np.asarray(line.y, float) for line in self.lines] or [np.zeros(1)])
        largest = np.max(values, initial=0.0, where=np.isfinite(values))
        if largest > 0.0 and not np.any(values < 0.0):
            self.y_limits = 0.0, 1.08 * largest


def rounded(values: list[float] | np.ndarray) -> list[Any]:
    """Numbers for JSON with a few significant digits; None for NaN."""
    return [None if v is None or not math.isfinite(v) else float(f"{v:.{DIGITS}g}") for v in np.asarray(values, float)]


def places(values: list[float] | np.ndarray) -> list[float]:
    """Coordinates keep more digits than values, since neighbouring points must remain distinct."""
    return [float(f"{v:.7g}") for v in np.asarray(values, float)]


def line_data(line: Line) -> dict[str, Any]:
    step = 1 if line.dots else max(1, math.ceil(len(line.x) / MOST_POINTS))
    data = {"label": line.label, "x": places(line.x[::step]), "y": rounded(line.y[::step]),
            "colour": to_hex(line.colour)}
    if line.case:
        data["case"] = line.case
    if line.error is not None and np.isfinite(line.error).any():
        data["error"] = rounded(line.error[::step])
    return data | {"dashed": line.dashed, "points": line.points, "dots": line.dots, "crossed": line.crossed}


def mark_data(mark: Mark) -> dict[str, Any]:
    return {name: value for name, value in {**vars(mark), "colour": to_hex(mark.colour)}.items() if value not in (None, "")}


def chart_data(chart: Chart) -> dict[str, Any]:
    """A chart as JSON object for charts.js."""
    limits = None if chart.y_limits is None else [float(v) for v in chart.y_limits]
    return {"x_label": chart.x_label, "y_label": chart.y_label.replace("$", ""), "title": chart.title, "x_names": chart.x_names,
            "x_log": chart.x_log, "y_log": chart.y_log, "y_limits": limits, "y_ticks": chart.y_ticks,
            "marks": [mark_data(mark) for mark in chart.marks], "lines": [line_data(line) for line in chart.lines]}
