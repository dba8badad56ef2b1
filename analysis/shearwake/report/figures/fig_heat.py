# SPDX-License-Identifier: BSD-3-Clause
"""Heat maps of a measure over two swept keys, with one panel per value of the other keys."""
from __future__ import annotations

import copy
import math
import textwrap
from dataclasses import replace
from itertools import product
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.patches import PathPatch
from matplotlib.path import Path as Outline

from ... import wake
from .. import answer, labels, layout, style, warnings_of
from ..figure import Figure
from ..load import Selection, traces
from ..page import hover
from ..words import counted, listed, number, some_of

NAME = "heat_"  # followed by the column
PANELS = 12
SQUARE = np.array([[-0.5, -0.5], [0.5, -0.5], [0.5, 0.5], [-0.5, 0.5], [-0.5, -0.5]])
COLUMNS = 3
WORDS = 18  # characters per line of a tick label
WRITTEN = 60  # largest number of cells with printed values
NUMBERS_pt = 8.0
PANEL_pt = 420.0, 250.0  # about the width and height of a single panel
LEAST = 3  # smallest number of values along both keys; fewer are drawn as curves

MEASURES = [
    ("eta_period_1", "Reconstruction efficiency"), ("eta_period_over_reference_1", "Efficiency relative to {reference}"),
    ("focal_rms_um", "Strength at the focus"), ("focal_rms_over_reference_1", "Strength relative to {reference}"),
    ("ipr_abs_period_mm2", "Spread of the vibration (IPR of |u|)"), ("participation_period_mm2", "Participation area"),
    ("felt_path_dB", "Level of sensation on the drawn shape"), ("peak_frequency_Hz", "Dominant frequency {place}"),
    ("velocity_peak_frequency_Hz", "Dominant frequency of the velocity {place}"),
]


def measure_label(selection: Selection, column: str, characters: int = 26) -> str:
    """The label of an axis with this column, in lines for a low panel."""
    return textwrap.fill(answer.column_label(selection, column), characters, break_on_hyphens=False, break_long_words=False)


def band_measures(selection: Selection) -> Any:
    """Shares of the energy at the trace point of the columns in the bands of the job."""
    found = dict.fromkeys(name for c in layout.ordinary(selection) for name in c.values
                          if name.startswith("share_"))
    for name in found:
        low, high = name.split("_")[1:3]
        yield (name, f"Fraction of the energy within {low} to {high} Hz {{place}}")


def receptor_measures(selection: Selection) -> Any:
    """The responses of each class of afferents."""
    for kind in layout.receptor_classes(selection):
        yield (f"{kind}_total_rate_Hz", f"Response of all {kind} afferents")


def plane(selection: Selection) -> tuple[str, str, list[Any]] | None:
    """x, y and the keys of the panels; None if curves are more suitable. If kinds change together with other keys, y are their
    combinations, see combined()."""
    keys = layout.axes(selection)
    if any(not layout.is_number(v) for k in keys for v in layout.values_of(selection, k)) and not is_full(selection, keys):
        x = independent(selection, keys)
        return (x, COMBINATION, []) if x and len(keys) > 2 else None
    if len(keys) < 2:
        return None
    counts = {k: len(layout.values_of(selection, k)) for k in keys}
    x = selection.x if selection.x in keys else keys[0]
    y = max((k for k in keys if k != x), key=lambda k: counts[k])
    enough = counts[x] >= LEAST and counts[y] >= LEAST
    if not enough and len(layout.groups(selection)) <= style.CURVES:
        return None
    return x, y, [k for k in keys if k not in (x, y)]


COMBINATION = "combination"


def is_full(selection: Selection, keys: list[str]) -> bool:
    """Whether all combinations of the values of these keys are swept."""
    there = {tuple(str(c.settings.get(k)) for k in keys) for c in layout.swept_cases(selection)}
    return len(there) == math.prod(len({t[i] for t in there}) for i in range(len(keys)))


def independent(selection: Selection, keys: list[str]) -> str | None:
    """A key that takes all of its values with each combination of the other keys, x if possible; None if there is none."""
    by_size = sorted(keys, key=lambda k: (k != selection.x, -len(layout.values_of(selection, k))))
    for key in by_size:
        there = {(str(c.settings.get(key)), tuple(str(c.settings.get(k)) for k in keys if k != key))
                 for c in layout.swept_cases(selection)}
        if len({a for a, _ in there}) * len({b for _, b in there}) == len(there):
            return key
    return None


def combined(selection: Selection, x: str) -> Selection:
    """The selection whose cases have the setting "combination", their swept values without x."""
    keys = [k for k in layout.axes(selection) if k != x]
    cases = [case if case.is_reference else copy.copy(case) for case in selection.cases]
    for case in cases:
        words = ", ".join(layout.setting_text(selection, k, case.settings[k]) for k in keys if k in case.settings)
        if not case.is_reference:
            case.settings = {**case.settings, COMBINATION: words}
        layout.labels(selection)[COMBINATION, words] = words
    return replace(selection, cases=cases)


def panels(selection: Selection, others: list[Any]) -> tuple[list[tuple[Any, ...]], int]:
    """The combinations of the other keys that are drawn, and the number of combinations that occur."""
    every = list(product(*(layout.values_of(selection, k) for k in others)))
    there = {tuple(c.settings.get(k) for k in others) for c in layout.swept_cases(selection)}
    every = [values for values in every if values in there]
    return layout.evenly(every, PANELS), len(every)


def cells(selection: Selection, column: str, x: str, y: str, others: list[Any], shown: list[tuple[Any, ...]]) -> list[tuple[np.ndarray,
          np.ndarray, np.ndarray, np.ndarray]]:
    """The values (y, x) of each panel, a mask of cells whose case has no result, a mask of values that are not valid, and the errors."""
    columns, rows = ({value: n for n, value in enumerate(layout.values_of(selection, key))} for key in (x, y))
    shape = len(rows), len(columns)
    made = {values: (np.full(shape, math.nan), np.zeros(shape, bool), np.zeros(shape, bool), np.full(shape, math.nan)) for values in shown}
    for case in layout.swept_cases(selection):
        own = case.settings
        values = tuple(own.get(k) for k in others)
        if x not in own or y not in own or values not in made:
            continue
        found, failed, invalid, error = made[values]
        place, of_case = (rows[own[y]], columns[own[x]]), case.values
        found[place], error[place] = of_case.get(column, math.nan), of_case.get(column + "_error", math.nan)
        failed[place] = not case.is_complete
        invalid[place] = math.isfinite(found[place]) and not warnings_of.is_valid_value(selection, case, column, NAME + column)
    return list(made.values())


def scale(grids: Any, relative: Any) -> Any:
    """Norm and colour map from the smallest to the largest value. Ratios have a logarithmic scale and a diverging map around 1."""
    every = np.concatenate([g[np.isfinite(g)] for g in grids])
    if relative and (limits := style.ratio_limits(every)):
        return plt.matplotlib.colors.LogNorm(*limits), plt.get_cmap(style.DIVERGING)
    low, high = every.min(), every.max()
    if high - low <= 1e-12 * abs(high):
        low, high = low - 0.5 * abs(low or 1.0), high + 0.5 * abs(high or 1.0)
    if low > 0 and high > 30 * low:
        return plt.matplotlib.colors.LogNorm(low, high), style.sequential_map()
    return plt.Normalize(low, high), style.sequential_map()


def ticks(axis: Any, key: str, selection: Selection, room: Any) -> None:
    values = layout.values_of(selection, key)
    every = max(1, math.ceil(len(values) / room))
    words = [number(float(v), 3) if layout.is_number(v) and (key, v) not in layout.labels(selection)
             else textwrap.fill(labels.value_text(selection, key, v), WORDS, break_on_hyphens=False) for v in values]
    axis.set_ticks(range(0, len(values), every), list(map(style.plain, words[::every])))
    longest = max(len(line) for word in words for line in word.splitlines())
    if axis.axis_name == "x" and longest * min(len(words), room) > 6 * room:
        axis.set_tick_params(rotation=35)
        for label in axis.get_ticklabels():
            label.set_horizontalalignment("right")


def rotation(words: Any, shape: Any) -> Any:
    """The angle in degrees at which numbers fit into the cells of a single panel without touching; None if they do not
    fit."""
    lines = [word.splitlines() for word in words]
    length = 0.64 * NUMBERS_pt * max(len(line) for word in lines for line in word) + 4.0  # digits are 0.64 em wide
    height = 1.4 * NUMBERS_pt * max(map(len, lines))
    cell = PANEL_pt[0] / shape[1], PANEL_pt[1] / shape[0]
    if length <= cell[0] and height <= cell[1]:
        return 0
    return 90 if length <= cell[1] and height <= cell[0] else None


def write_numbers(axes: Axes, values: Any, norm: Any, colours: Any, error: np.ndarray) -> None:
    """Writes the finite values, with their errors, into their cells if there is room."""
    words = {place: number(value, 3) + (f"\n± {number(error[place], 2)}" if np.isfinite(error[place]) else "")
             for place, value in np.ndenumerate(values) if np.isfinite(value)}
    angle = rotation(words.values(), values.shape) if words else None
    if angle is None:
        return
    for (row, column), word in words.items():
        red, green, blue, _ = colours(norm(values[row, column]))
        dark = 0.3 * red + 0.59 * green + 0.11 * blue < 0.55
        axes.text(column, row, word, ha="center", va="center", fontsize=NUMBERS_pt, rotation=angle,
                  color="white" if dark else style.INK)


def draw(axes: Axes, grid: Any, failed: Any, invalid: Any, norm: Any, colours: Any, written: Any, error: Any) -> None:
    valid = np.where(invalid, math.nan, grid)
    axes.imshow(valid, origin="lower", aspect="auto", norm=norm, cmap=colours,
                interpolation="nearest")
    ends = np.array([-0.5, 0.5, math.nan])
    diagonals = [(column + ends, row + sign * ends) for row, column in np.argwhere(invalid) for sign in (1, -1)]
    if diagonals:
        axes.plot(*np.concatenate(diagonals, axis=1), color=style.GREY, linewidth=1.0, zorder=1.5, scalex=False, scaley=False)
    empty = ~np.isfinite(grid)
    for mask, mark in ((empty & ~failed, "////"), (empty & failed, "xxxx")):
        corners = [SQUARE + [column, row] for row, column in np.argwhere(mask)]
        if corners:  # one hatched area, since each patch takes a millisecond; without its effect on the limits
            squares = Outline(np.concatenate(corners), np.tile(Outline(SQUARE, closed=True).codes, len(corners)))
            axes.add_artist(PathPatch(squares, facecolor="#f1f1f1", edgecolor="#9a9a9a", hatch=mark, linewidth=0))
    if written:
        write_numbers(axes, valid, norm, colours, error)
    axes.grid(False)


def columns_of(selection: Selection, others: Any, count: Any) -> Any:
    """The number of columns: the number of values of the last key if they fit."""
    last = len(layout.values_of(selection, others[-1])) if others else 1
    if len(others) > 1 and last <= 4 and count % last == 0:
        return last
    return 2 if count == 4 else min(COLUMNS, count)


def heat_figure(selection: Selection, measure: tuple[str, str], plan: tuple[str, str, list[str]]) -> Figure | None:
    column, title = measure
    x, y, others = plan
    shown, of = panels(selection, others)
    every = cells(selection, column, x, y, others, shown)
    grids = [np.where(invalid, math.nan, g) for g, _, invalid, _ in every]
    if not any(np.isfinite(g).any() for g in grids):
        return None
    reference = layout.reference_name(layout.all_references(selection))
    place = layout.place_words(traces(c).measured_m for c in layout.recordings(selection) if traces(c))
    title, label = title.format(reference=reference, place=place), answer.column_label(selection, column)
    norm, colours = scale(grids, selection.is_ratio(column))
    columns = columns_of(selection, others, len(shown))
    rows = math.ceil(len(shown) / columns)
    height = 3.6 if rows == 1 and columns == 1 else 2.1
    figure, made = style.panels(len(shown), columns, height, 0.8, sharex=True, sharey=True)
    for axes, values, (grid, failed, invalid, error) in zip(made.flat, shown, every):
        draw(axes, grid, failed, invalid, norm, colours, grid.size <= WRITTEN and len(shown) == 1, error)
        settings = ", ".join(layout.setting_text(selection, k, v) for k, v in zip(others, values))
        hover.attach(axes, grid, (-0.5, grid.shape[1] - 0.5), (-0.5, grid.shape[0] - 0.5), label, "", "", title=settings, x_names=[
            layout.setting_text(selection, x, v) for v in layout.values_of(selection, x)], y_names=[
                layout.setting_text(selection, y, v) for v in layout.values_of(selection, y)], invalid=invalid, error=error)
        axes.set_title(layout.wrapped(settings, 6.6 / columns), loc="left", fontsize=9)
    for i in range(len(shown)):
        made.flat[i].tick_params(labelbottom=i + columns >= len(shown))
    ticks(made[0, 0].xaxis, x, selection, 15 // columns + 1)
    ticks(made[0, 0].yaxis, y, selection, 12 if rows == 1 else 8)
    figure.supxlabel(labels.axis_label(selection, x), fontsize=9.5)
    figure.supylabel(labels.axis_label(selection, y), fontsize=9.5)
    bar = style.bar_beside(figure, plt.cm.ScalarMappable(norm=norm, cmap=colours), list(made.flat), label, aspect=30, pad=0.02)
    if selection.is_ratio(column) and isinstance(norm, plt.matplotlib.colors.LogNorm):
        style.ratio_axis(bar.ax.yaxis, (norm.vmin, norm.vmax))
    name = NAME + column
    head = f"{title} over {labels.name(selection, x)} and {labels.name(selection, y)}"
    text = caption(every, [labels.name(selection, k) for k in others], len(shown), of)
    return Figure(figure, name, head, text, head + ", as colours")


def caption(every: Any, others: Any, shown: Any, of: Any) -> str:
    text = "Each cell is a case; the cells are equidistant irrespective of their values."
    if others:
        text += f" One panel per {listed(others)}, with the same colour scale in all panels."
    if shown < of:
        text += f" {some_of(shown, of, 'panel')}, spread evenly; the table (CSV) lists all cases."
    failed, invalid = (sum(int(cell[i].sum()) for cell in every) for i in (1, 2))
    empty = sum(int((~np.isfinite(cell[0])).sum()) for cell in every) - failed
    if invalid:
        text += f" White with a cross: {counted(invalid, 'case')} not valid, excluded from the colour scale."
    if failed:
        text += f" Cross-hatched: {failed} without a result, see \"Not in the figures\"."
    if empty:
        text += f" Hatched: {empty} without a value or not swept; the reasons are in the table."
    return text


def figures(selection: Selection, part: slice = slice(None)) -> list[Any]:
    """The maps of the measures, or of a part of them."""
    plan = plane(selection)
    if plan is None:
        return []
    if plan[1] == COMBINATION:
        selection = combined(selection, plan[0])
    many = len(layout.groups(selection)) > style.CURVES  # otherwise the other measures are drawn as curves
    measures = list(MEASURES if many else MEASURES[:4])
    if not all(wake.is_passed(c, *traces(c).measured_m) for c in layout.recordings(selection)):
        measures = [m for m in measures if "frequency" not in m[0]]  # some foci stay far from the point
    else:
        measures += band_measures(selection)
    measures += receptor_measures(selection)
    return [f for m in measures[part] if (f := heat_figure(selection, m, plan))]
