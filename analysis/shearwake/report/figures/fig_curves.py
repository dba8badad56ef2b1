# SPDX-License-Identifier: BSD-3-Clause
"""Curves of a measure against the swept key: the mean over periods above, the instant below."""
from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.lines import Line2D
from matplotlib.ticker import NullFormatter, NullLocator

from .. import answer, labels, layout, style, warnings_of
from ..figure import Figure
from ..load import Selection
from ..page.curve_chart import curve_chart, draw_errors, error_caption
from ..validity import CROSSES, invalid_caption, split
from ..words import SUPERSCRIPTS, counted, is_at_instant, number

LEAST_HEIGHT = 0.02  # of the y axis, relative to its middle


def set_x_axis(axes: Axes, selection: Selection) -> None:
    """Puts ticks at the swept values if they fit; strings of x become labels."""
    values = layout.x_values(selection)
    axes.set_xlabel(labels.axis_label(selection, selection.x))
    if not layout.is_numeric(selection):
        few = len(values) <= 6
        axes.set_xticks(range(len(values)), [style.plain(labels.value_text(selection, selection.x, v)) for v in values],
                        rotation=0 if few else 30, ha="center" if few else "right")
        axes.set_xlim(-0.5, len(values) - 0.5)
        return
    if layout.is_logarithmic(values):
        axes.set_xscale("log")
        axes.xaxis.set_major_formatter(style.PlainFormatter())
        places = np.log(values)
    else:
        places = np.array(values, dtype=float)
    room = np.ptp(places) or max(1.0, abs(places[0]))
    ends = np.array([places[0] - 0.045 * room, places[-1] + 0.045 * room])
    axes.set_xlim(*(np.exp(ends) if axes.get_xscale() == "log" else ends))
    if len(values) <= 12 and (len(values) < 2 or np.min(np.diff(places)) > 0.055 * room):
        axes.set_xticks(values, tick_labels(values))
        axes.xaxis.set_minor_locator(NullLocator())
        axes.xaxis.set_minor_formatter(NullFormatter())


def tick_labels(values: list[float]) -> list[str]:
    """The numbers with six digits or, where these labels would touch, with the three that still distinguish them."""
    exact, short = ([number(float(v), digits) for v in values] for digits in (6, 3))
    return short if sum(map(len, exact)) > 60 and len(set(short)) == len(values) else exact


def points(selection: Selection, group: layout.Group, column: str, aside: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """x and y of a curve. `aside` shifts x if it is a string, so that curves do not hide each other."""
    x = [layout.x_position(selection, c) + aside for c in group.cases]
    return np.array(x), np.array([layout.curve_value(selection, c, column) for c in group.cases])


def draw_curve(axes: Axes, selection: Selection, group: layout.Group, column: str, figure: str, aside: float = 0.0,
               **look: Any) -> tuple[np.ndarray, np.ndarray]:
    """Draws the values of a column; those that are not valid in this figure become grey crosses without a line. Returns x
    and y of the curve."""
    x, y = points(selection, group, column, aside)
    y, invalid = split(selection, group.cases, column, figure, y)
    axes.plot(x, y, **{"zorder": 3, **look})
    if np.isfinite(invalid).any():
        axes.plot(x, invalid, **CROSSES)
    return x, y


def asides(selection: Selection, curves: list[tuple[layout.Group, str, str]]) -> list[float]:
    middle = 0.5 * (len(curves) - 1)
    step = 0.0 if layout.is_numeric(selection) else 0.12
    return [step * (i - middle) for i in range(len(curves))]


def draw_reference(axes: Axes, selection: Selection, group: layout.Group, column: str, figure: str, colour: str, line: str,
                   labels: list[Any], name: str) -> None:
    """Draws a single reference as a horizontal line, and one reference per x as a line in the colour of the
    curve. References that are not valid in this figure are grey: a dotted line or crosses."""
    found = [r for r in layout.references(selection, group) if r.is_reference]
    look = {"color": colour, "linestyle": line, "linewidth": 1.3, "zorder": 1.5}
    if not found:
        return
    if len(found) == 1:
        value = found[0].value(column, math.nan)
        if math.isnan(value):
            return
        text = f"{name}\n{number(value, 3)}"
        if not warnings_of.is_valid(found[0], figure):
            colour, text = style.GREY, f"{name}\nnot valid"
            look |= {"color": colour, "linestyle": ":"}
        axes.axhline(value, **look)
    else:
        pairs = [(layout.x_position(selection, c), r) for c in group.cases if (r := selection.added_reference_of(c))]
        x, own = [at for at, _ in pairs], [r for _, r in pairs]
        y, invalid = split(selection, own, column, figure, np.array([r.value(column, math.nan) for r in own]))
        axes.plot(x, invalid, **CROSSES)
        if not np.isfinite(y).any():
            return
        if not layout.is_numeric(selection):  # strings have no order: a dash at each
            for at, value in zip(x, y):
                axes.plot([at - 0.3, at + 0.3], [value, value], **look)
        elif is_at_instant(column):
            axes.plot(x, y, color=colour, linestyle="none", marker="_", markersize=12, markeredgewidth=1.6, zorder=1.5)
        else:
            axes.plot(x, y, **look)
        value, text = y[np.isfinite(y)][-1], name
    if (text, colour) not in [(t, c) for _, t, c in labels]:
        labels.append((value, text, colour))


def reference_lines(axes: Axes, selection: Selection, curves: list[tuple[layout.Group, str, str]], column: str,
                    figure: str) -> list[tuple[float, str, str]]:
    """Draws all references of a panel dashed and returns their labels for the right edge."""
    names = layout.reference_name(layout.all_references(selection))
    colours = {group.label: colour for group, colour, _ in curves}
    labels: list[Any] = []
    sets = layout.by_reference(selection, [group for group, _, _ in curves], column)
    for same in sets:
        own = style.INK if len(sets) == 1 else colours[same[0].label]
        draw_reference(axes, selection, same[0], column, figure, own, "--", labels, names)
    if len(labels) <= 6:
        return labels
    handles = [Line2D([], [], color=colour, linestyle="--", label=text.replace("\n", " ")) for _, text, colour in labels]
    axes.legend(handles=handles, loc="upper left", bbox_to_anchor=(1.0, 1.0), fontsize=7)
    return []


def widen(axes: Axes) -> None:
    """Widens the y axis of a flat curve, which would otherwise show only rounding errors."""
    if axes.get_yscale() == "log":
        return
    low, high = axes.get_ylim()
    middle = 0.5 * (low + high)
    if middle and high - low < LEAST_HEIGHT * abs(middle):
        axes.set_ylim(middle * (1 - LEAST_HEIGHT / 2), middle * (1 + LEAST_HEIGHT / 2))


def legend_above(figure: Any, curves: list[tuple[layout.Group, str, str]]) -> None:
    """A legend with one entry per curve, above the panels."""
    if len(curves) < 2:
        return
    lines = [Line2D([], [], color=colour, marker=marker, label=group.label or "all")
             for group, colour, marker in curves]
    figure.legend(handles=lines, ncol=legend_columns(curves), loc="upper center",
                  bbox_to_anchor=(0.48, 1.0 - 0.08 / figure.get_figheight()))


def curves_of(selection: Selection) -> list[tuple[layout.Group, str, str]]:
    found = layout.groups(selection)
    colours = style.distinct(len(found))
    return [(g, colours[i], style.MARKERS[i % len(style.MARKERS)]) for i, g in enumerate(found)]


def legend_columns(curves: list[tuple[layout.Group, str, str]]) -> int:
    """The number of columns that fit into a line of about 100 characters."""
    longest = max(len(group.label) for group, _, _ in curves) + 8  # for the marker
    return max(1, min(4, len(curves), 100 // longest))


def panels(count: int, curves: list[tuple[layout.Group, str, str]], height_in: float = 2.35) -> tuple[Any, list[Axes]]:
    """Stacked axes with room for labels at the right and for the legend above; lengths are in inches."""
    rows = 0 if len(curves) < 2 else math.ceil(len(curves) / legend_columns(curves))
    top, bottom, between = 0.4 + 0.25 * rows if rows else 0.3, 0.62, 0.42
    total = top + bottom + count * height_in + (count - 1) * between
    figure = plt.figure(figsize=(style.width_in(), total))
    made: list[Axes] = []
    for i in range(count):
        y = bottom + (count - 1 - i) * (height_in + between)
        made.append(figure.add_axes([0.85 / style.width_in(), y / total, (style.width_in() - 1.95) / style.width_in(),
                                     height_in / total], sharex=made[0] if made else None))
    for axes in made[:-1]:
        axes.tick_params(labelbottom=False)
    return figure, made


def has_any(selection: Selection, column: str | None) -> bool:
    return column is not None and any(not math.isnan(c.value(column, math.nan)) for c in layout.ordinary(selection))


def move_power_to_label(axes: Axes) -> None:
    """Moves the power of ten from the axis to the label: '1.9 ... 2.7 (10⁻⁷ mm²)'."""
    largest = max(abs(limit) for limit in axes.get_ylim())
    if axes.get_yscale() == "log" or not 0 < largest < 1e-3:
        return
    exponent = math.floor(math.log10(largest))
    power = f"10{str(exponent).translate(SUPERSCRIPTS)}"
    axes.yaxis.set_major_formatter(lambda value, _: number(value / 10.0**exponent))
    axes.set_ylabel(axes.get_ylabel().replace("(mm²)", f"({power} mm²)"))


def spans_decades(selection: Selection, column: str) -> bool:
    values = [c.value(column, math.nan) for c in [*layout.ordinary(selection), *layout.all_references(selection)]]
    values = [v for v in values if not math.isnan(v)]
    return min(values) > 0 and max(values) > 10 * min(values)


def instant_title(selection: Selection) -> str:
    """'at the instant t = 14 ms', if it is the same for all cases."""
    times = {round(1e3 * c.setting("measure", "at_s"), 9) for c in layout.ordinary(selection)}
    return f"at the instant t = {number(times.pop())} ms" if len(times) == 1 else "at one instant"


def measure_figure(selection: Selection, measure: dict[str, Any]) -> Figure | None:
    """Writes the figure of one measure; None if no case has a value."""
    period, instant = measure["period"], measure["instant"]
    rows = [c for c in (period, instant) if has_any(selection, c)]
    if not selection.x or not rows:
        return None
    curves = curves_of(selection)
    numeric = layout.is_numeric(selection)
    figure, made = panels(len(rows), curves)
    for axes, column in zip(made, rows):
        over_periods = column == period
        for (group, colour, marker), aside in zip(curves, asides(selection, curves)):
            look: dict[str, Any] = {"clip_on": False} if over_periods else {"markerfacecolor": "white"}
            x, y = draw_curve(axes, selection, group, column, measure["name"], aside, marker=marker, color=colour,
                              linestyle="-" if numeric and over_periods else "none", **look)
            draw_errors(axes, x, y, group.cases, column, colour)
        if measure.get("log") and spans_decades(selection, column):
            axes.set_yscale("log")
        ends = reference_lines(axes, selection, curves, column, measure["name"])
        axes.margins(y=0.12)
        widen(axes)
        axes.set_ylabel(answer.column_label(selection, column))
        move_power_to_label(axes)
        axes.yaxis.set_label_coords(-0.105, 0.5)
        axes.set_title("mean over periods" if over_periods else instant_title(selection), loc="left",
                       color="#555555")
        style.label_right(axes, ends)
    set_x_axis(made[-1], selection)
    for axes in made if not numeric else []:
        axes.grid(False, axis="x")
    legend_above(figure, curves)
    title = measure["title"].format(x=labels.name(selection, selection.x))
    charts = [curve_chart(selection, measure["name"], column,
                          "mean over periods" if column == period else instant_title(selection),
                          bool(measure.get("log") and spans_decades(selection, column))) for column in rows]
    return Figure(figure, measure["name"], title,
                  measure["caption"].format(region=region_words(selection)) + marker_caption(selection, rows, period, instant)
                  + error_caption(selection, *rows) + invalid_caption(selection, measure["name"], *rows),
                  f"{title}: mean over periods and instant, with the reference as dashed lines", charts)


def is_modulated(selection: Selection) -> bool:
    """Whether a case has a modulation; plain STM has none."""
    return any(c.setting("load", "modulation", "kind", default="") != "STM" for c in layout.ordinary(selection))


def is_steady(selection: Selection) -> bool:
    """Whether all cases are in the periodic regime."""
    return all(layout.repeats(c) for c in layout.ordinary(selection))


def region_words(selection: Selection) -> str:
    """The region over which the measures are taken, as a part of a sentence."""
    areas = [c.value("region_mm2", math.nan) for c in layout.ordinary(selection)]
    areas = [area for area in areas if not math.isnan(area)]
    if not areas:
        return f"{layout.plane_name(layout.ordinary(selection))} within the domain"
    low, high = number(min(areas) / 100.0, 3), number(max(areas) / 100.0, 3)
    return f"the measured region ({low if low == high else f'{low} to {high}'} cm²)"


def period_words(selection: Selection) -> str:
    if is_steady(selection):
        return "one period of the load"
    return "complete modulation periods" if is_modulated(selection) else "the settled part of the run"


def marker_caption(selection: Selection, rows: list[str], period: str, instant: str | None) -> str:
    """Explains the markers; in detail for eta, whose figure is the first."""
    if period != "eta_period_1":
        return " Panels and lines as in the figure of the efficiency."
    sentences = []
    if period in rows:
        sentences.append(f" Mean over periods: the energy-weighted mean over {period_words(selection)}.")
    if instant in rows:
        text = f" {instant_title(selection)[:1].upper()}{instant_title(selection)[1:]}: the value at a single instant, not joined by lines"
        if is_modulated(selection):
            text += ", which depends on the phase of the modulation at that instant; its variation is not a trend"
        sentences.append(text + ".")
    if layout.added_references(selection):
        sentences.append(f" Dashed lines: {layout.reference_name(layout.added_references(selection))}, "
                         "evaluated in the same way.")
        found = layout.groups(selection)
        if 1 < len(layout.by_reference(selection, found, rows[0])) < len(found):
            sentences.append(" A line that belongs to several curves has the colour of the first of them.")
    missing = sum(math.isnan(c.value(period, math.nan)) for c in layout.ordinary(selection))
    if missing:
        every = counted(len(layout.ordinary(selection)), "case")
        sentences.append(f" {missing} of {every} {'has' if missing == 1 else 'have'} no mean over periods; the "
                         "reasons are listed below the table.")
    if period in rows:
        sentences.append(" The vertical axes do not start at zero.")
    return "".join(sentences)
