# SPDX-License-Identifier: BSD-3-Clause
"""Curves of measures against the swept key: the mean over periods above, the instant below."""
from __future__ import annotations

import math
from typing import Any

from .. import labels, layout
from ..figure import Figure
from ..load import Selection
from ..page.chart import Chart
from ..page.curve_chart import curve_chart, error_caption
from ..validity import invalid_caption
from ..words import counted, number
from .chart_figure import chart_figure


def curves_figure(selection: Selection, name: str, title: str, charts: dict[str, Chart], caption: str, height_in: float = 2.1) -> Figure:
    """The figure of curves of some columns."""
    return Figure(chart_figure(list(charts.values()), height_in), name, title,
                  caption + error_caption(selection, *charts) + invalid_caption(selection, name, *charts), title, list(charts.values()))


def has_any(selection: Selection, column: str | None) -> bool:
    return column is not None and any(not math.isnan(c.value(column, math.nan)) for c in layout.ordinary(selection))


def spans_decades(selection: Selection, column: str) -> bool:
    values = [c.value(column, math.nan) for c in [*layout.ordinary(selection), *layout.all_references(selection)]]
    values = [v for v in values if not math.isnan(v)]
    return min(values) > 0 and max(values) > 10 * min(values)


def instant_title(selection: Selection) -> str:
    """'at the instant t = 14 ms', if it is the same for all cases."""
    times = {round(1e3 * c.setting("measure", "at_s"), 9) for c in layout.ordinary(selection)}
    return f"at the instant t = {number(times.pop())} ms" if len(times) == 1 else "at one instant"


def measure_figure(selection: Selection, measure: dict[str, Any]) -> Figure | None:
    """The figure of one measure; None if no case has a value."""
    period, instant = measure["period"], measure["instant"]
    rows = [c for c in (period, instant) if has_any(selection, c)]
    if not selection.x or not rows:
        return None
    charts = {column: curve_chart(selection, measure["name"], column, "mean over periods" if column == period else instant_title(selection),
                                  bool(measure.get("log")) and spans_decades(selection, column)) for column in rows}
    caption = measure["caption"].format(region=region_words(selection)) + marker_caption(selection, rows, period, instant)
    return curves_figure(selection, measure["name"], measure["title"].format(x=labels.name(selection, selection.x)), charts, caption)


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
