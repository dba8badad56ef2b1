# SPDX-License-Identifier: BSD-3-Clause
"""Snapshots of the surface: one column per curve, the reference above, x increasing downwards."""
from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ... import wake
from ...case import Case
from ...errors import NotRecorded
from .. import layout, load, references, style, warnings_of
from ..figure import Figure
from ..page import hover
from ..words import counted, listed, number

COLUMNS = 4  # largest number of curves side by side
ALL_ROWS = 5  # up to this number of values of x, all are drawn
SEEN = 0.1  # smallest visible displacement relative to the end of the colour scale


@dataclass
class Snapshot:
    case: Case
    t_s: float
    x_mm: np.ndarray
    y_mm: np.ndarray
    u_um: np.ndarray  # (x, y)


def shot_of(case: Case, index: int) -> Snapshot:
    t_s, x, y, u = case.snapshot(index)
    return Snapshot(case, t_s, 1e3 * x, 1e3 * y, 1e6 * u)


def snapshot(case: Case) -> Snapshot | None:
    try:
        found = shot_of(case, -1)
    except NotRecorded:
        return None
    return found if np.any(np.isfinite(found.u_um)) else None


def some_rows(cases: list[Case], columns: int) -> list[Case]:
    """The cases of one curve: all if there are few, else some, spread evenly."""
    most = {1: 5, 2: 4}.get(columns, 3)
    return list(cases) if len(cases) <= (ALL_ROWS if columns < 3 else 4) else layout.evenly(cases,
                                                                                         most)


def cells(selection: load.Selection) -> tuple[Any, ...]:
    """The cases of the panels row by row (None: empty panel) and the number of columns. A single curve with one
    reference fills two columns; other curves have one column each, and references that depend on x another."""
    groups = layout.groups(selection)
    depend_on_x = any(len(references.of_cases(selection, g.cases)) > 1 for g in groups)
    found = layout.evenly(groups, COLUMNS // 2 if depend_on_x else COLUMNS)
    if len(found) == 1 and not depend_on_x:
        cases = references.of_cases(selection, found[0].cases) + some_rows(found[0].cases, 1)
        return cases, min(2, len(cases))
    width = len(found) + depend_on_x
    columns = references.columns_of(selection, found, lambda cases: some_rows(cases, width))
    rows = max(map(len, columns), default=0)
    columns = [column + [None] * (rows - len(column)) for column in columns]
    return [column[row] for row in range(rows) for column in columns], len(columns)


def scale(shots: list[Snapshot]) -> float:
    """End of the colour scale, see wake.scale_end()."""
    return wake.scale_end([(s.case, s.t_s, s.x_mm, s.y_mm, s.u_um) for s in shots])


def window(shots: list[Snapshot], end: float, points: np.ndarray = np.empty((0, 2))) -> tuple[float, float, float, float]:
    """The rectangle, common to all snapshots, that contains all visible displacement and the path, and points in mm."""
    low, high = np.full(2, math.inf), np.full(2, -math.inf)
    for s in shots:
        seen = np.abs(s.u_um) > SEEN * end
        for axis, places in enumerate((s.x_mm, s.y_mm)):
            where = places[seen.any(axis=1 - axis)]
            if len(where):
                low[axis], high[axis] = min(low[axis], where[0]), max(high[axis], where[-1])
    points = np.concatenate([points, *(wake.focus_at(s.case, s.t_s)[2] for s in shots)])
    low, high = np.minimum(low, points.min(axis=0)) - 3.0, np.maximum(high, points.max(axis=0)) + 3.0
    return (max(low[0], *(s.x_mm[0] for s in shots)), min(high[0], *(s.x_mm[-1] for s in shots)),
            max(low[1], *(s.y_mm[0] for s in shots)), min(high[1], *(s.y_mm[-1] for s in shots)))


def extent(shot: Snapshot) -> tuple[float, float, float, float]:
    return wake.extent(shot.x_mm, shot.y_mm)


def frame(axes: Axes, limits: tuple[float, float, float, float]) -> None:
    axes.set_xlim(*limits[:2])
    axes.set_ylim(*limits[2:])
    axes.set_aspect("equal")
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(True)


def draw(axes: Axes, shot: Snapshot, norm: Any, limits: tuple[float, float, float, float]) -> tuple[Any, bool]:
    image = axes.imshow(shot.u_um.T, origin="lower", cmap=style.DIVERGING, norm=norm,
                        extent=extent(shot), interpolation="bicubic", interpolation_stage="data")
    lines = wake.draw_theory(axes, shot.case, shot.t_s)
    frame(axes, limits)
    attach_values(axes, shot.x_mm, shot.y_mm, shot.u_um, limits)
    fitted = shot.case.value("mach_angle_deg", math.nan)
    if not math.isnan(fitted) and warnings_of.is_valid(shot.case):
        text = note(axes, f"fitted: {number(fitted, 3)}°", style.INK)
        text.set_bbox({"facecolor": "white", "alpha": 0.7, "linewidth": 0, "pad": 1.0})
    return image, lines


def attach_values(axes: Axes, x: np.ndarray, y: np.ndarray, u: np.ndarray, limits: tuple[float, float, float, float],
                  what: str = "u", unit: str = "µm") -> None:
    """Adds the values u(x, y) within the limits to a map of the surface."""
    i, j = (np.flatnonzero((at >= low) & (at <= high)) for at, low, high in ((x, *limits[:2]), (y, *limits[2:])))
    half_x, half_y = np.diff(x[:2])[0] / 2, np.diff(y[:2])[0] / 2
    hover.attach(axes, u[np.ix_(i, j)].T, (x[i[0]] - half_x, x[i[-1]] + half_x), (y[j[0]] - half_y, y[j[-1]] + half_y), what,
                 "x (mm)", "y (mm)", unit)


def draw_threshold(axes: Axes, levels: tuple[np.ndarray, np.ndarray, np.ndarray], colour: str = style.INK) -> None:
    """The line where the level of sensation is 0 dB: x_m, y_m, level_dB(x, y)."""
    x, y, level = levels
    if np.nanmin(level, initial=math.inf) < 0.0 < np.nanmax(level, initial=-math.inf):
        axes.contour(1e3 * x, 1e3 * y, level.T, levels=[0.0], colors=[colour], linewidths=1.4)


def note(axes: Axes, text: str, colour: str) -> Any:
    """Writes a short text in the lower right corner of a map."""
    return axes.text(0.97, 0.04, text, transform=axes.transAxes, fontsize=8, color=colour, ha="right")


def arrange(selection: load.Selection, shots: list[Any], columns: int,
            limits: tuple[float, float, float, float]) -> tuple[Any, list[Axes], Axes]:
    """Axes of equal scale with titles, hidden where there is no snapshot, and the axes of the colour bar.
    Lengths are in inches."""
    rows = math.ceil(len(shots) / columns)
    left, right, between, bottom = 0.62, 0.12, 0.24, 1.28
    width = (style.width_in() - left - right - (columns - 1) * between) / columns
    height = width * (limits[3] - limits[2]) / (limits[1] - limits[0])
    highest = 5.0 if rows < 3 else 2.3
    if height > highest:
        left += 0.5 * columns * width * (1.0 - highest / height)
        width, height = width * highest / height, highest
    labels = [warnings_of.label(selection, s.case, "surface") if s else "" for s in shots]
    titles = [layout.wrapped(label, width) if label != layout.ONLY_CASE else "" for label in labels]
    down = 0.2 + 0.16 * max(t.count("\n") + 1 for t in titles)  # between rows
    total = rows * (height + down) + bottom
    figure = plt.figure(figsize=(style.width_in(), total))
    made = []
    for i, shot in enumerate(shots):
        row, column = divmod(i, columns)
        place = (left + column * (width + between), bottom + (rows - 1 - row) * (height + down),
                 width, height)
        made.append(figure.add_axes([place[0] / style.width_in(), place[1] / total,
                                     place[2] / style.width_in(), place[3] / total]))
        made[-1].set_visible(shot is not None)
        made[-1].set_title(titles[i], loc="left", pad=4)
        is_last = i + columns >= len(shots) or shots[i + columns] is None
        made[-1].tick_params(labelleft=column == 0, labelbottom=is_last)
        if column == 0:
            made[-1].set_ylabel("y (mm)")
        if is_last:
            made[-1].set_xlabel("x (mm)")
    bar = figure.add_axes([0.22, 0.5 / total, 0.56, 0.13 / total])
    return figure, made, bar


def draw_scale(figure: Any, image: Any, axes: Axes, label: str, extend: str) -> None:
    bar = figure.colorbar(image, cax=axes, orientation="horizontal", label=label, extend=extend)
    bar.outline.set_linewidth(0.5)
    axes.grid(False)


def times(shots: list[Snapshot]) -> str:
    found = sorted({s.t_s for s in shots})
    return f"{' to '.join(number(1e3 * t) for t in dict.fromkeys([found[0], found[-1]]))} ms"


def figures(selection: load.Selection) -> list[Figure]:
    cases, columns = cells(selection)
    grid = [snapshot(c) if c else None for c in cases]
    shots = [s for s in grid if s]
    if not shots:
        return []
    end = scale(shots)
    limits = window(shots, end)
    figure, made, bar_axes = arrange(selection, grid, columns, limits)
    any_lines = False
    for axes, shot in zip(made, grid):
        if shot:
            image, lines = draw(axes, shot, plt.Normalize(-end, end), limits)
            any_lines = any_lines or lines
    peak = max(np.nanmax(np.abs(s.u_um)) for s in shots)
    clipped = peak > 1.001 * end
    label = "$u_z$ (µm), positive into the tissue"
    if clipped:
        label += ("\n" if style.width_in() < 5.0 else " ").join((";", f"clipped at ±{number(end, 2)}, the focus reaches {number(peak, 3)}"))
    draw_scale(figure, image, bar_axes, label, "both" if clipped else "neither")
    plane = layout.plane_name([s.case for s in shots])
    title = f"{plane[:1].upper()}{plane[1:]} at {times(shots)}"
    text = caption(shots, any_lines, clipped)
    return [Figure(figure, "surface", title, text, title + ", seen from above",
                   cases=[s.case.id for s in shots])]


def caption(shots: list[Snapshot], any_lines: bool, clipped: bool) -> str:
    text = (f"Displacement of {layout.plane_name([s.case for s in shots])} seen from above, on the same colour scale in all panels. Solid circle with a "
            "centre point: focal disc. Dotted line: path of the focus so far.")
    if clipped:
        text += (f" The scale ends at the largest displacement farther than {number(wake.AWAY)} focal radii from the "
                 "focus, so that the wake is visible, but at least at a fifth of the peak; larger values are "
                 "clipped.")
    if any_lines:
        angles = {number(s.case.value("mach_angle_theory_deg", math.nan), 3) for s in shots} - {""}
        text += (" Dashed: theoretical Mach lines, sin θ = Rayleigh speed / focus speed at that instant, "
                 f"θ = {listed(a + '°' for a in sorted(angles))}; their length follows from the path.")
    if any(not math.isnan(s.case.value("mach_angle_deg", math.nan)) and warnings_of.is_valid(s.case) for s in shots):
        text += " Fitted: angle of the computed wake, if its edge is straight."
    without: dict[str, list[Case]] = {}
    for s in shots:
        if reason := s.case.notes.get("mach_angle_theory_deg"):
            without.setdefault(reason, []).append(s.case)
    for reason, cases in without.items():
        which = f" in {counted(len(cases), 'panel')}" if any_lines else ""
        text += f" No Mach lines{which}: {reason}."
    return text
