# SPDX-License-Identifier: BSD-3-Clause
"""A measure over time for every case, one panel per curve."""
from __future__ import annotations

import math
from typing import Any

import matplotlib.pyplot as plt
import numpy as np

from ...case import Case
from .. import answer, labels, layout, style, warnings_of
from ..figure import Figure
from ..layout import Panel
from ..load import Selection
from ..page.chart import Chart, Line, Mark
from ..words import number
from .chart_figure import chart_figure

DECADES = 1e4  # largest range of a logarithmic axis: values drop to zero where a sum changes its sign


def in_mm2(case: Case, name: str) -> np.ndarray:
    spacing_mm = 1e3 * case.setting("domain", "spacing_m")
    return case.over_time[name] * spacing_mm**2


MEASURES = [
    {"name": "eta_time", "title": "Reconstruction efficiency over time", "column": "eta_period_1",
     "value": lambda case: case.over_time["eta"], "needs": "eta",
     "caption": "η(t), the fraction of Σu² within the focal disc."},
    {"name": "ipr_abs_time", "title": "Spread of the vibration (IPR of |u|) over time", "column": "ipr_abs_period_mm2",
     "value": lambda case: in_mm2(case, "ipr_abs"), "needs": "ipr_abs",
     "caption": "The area over which the displacement is spread.",
     "transient": " It increases while waves propagate away from the path."},
    {"name": "ipr_time", "title": "Inverse participation ratio of the thesis over time", "column": "ipr_period_mm2",
     "value": lambda case: in_mm2(case, "ipr"), "needs": "ipr",
     "log": True,
     "caption": "ipr(t) as the thesis defines it. In nearly incompressible tissue it measures compressibility, not spread, and "
                "it drops whenever Σu changes its sign."},
]


def time_ms(case: Case) -> np.ndarray:
    return 1e3 * case.over_time["time"]


def settled(case: Case) -> np.ndarray:
    after, at = case.setting("measure", "settled_after_s"), case.setting("measure", "at_s")
    time = case.over_time["time"]
    return (time >= after) & (time <= at * (1 + 1e-9))


def limits(cases: list[Case], measure: dict[str, Any]) -> tuple[float, float] | None:
    """Limits of the y axis from the settled part only: while the waves are still close to the focus, the
    measures are meaningless."""
    values = np.concatenate([measure["value"](c)[settled(c)] for c in cases])
    values = values[np.isfinite(values)]
    if not measure.get("log"):
        return (0.0, 1.08 * values.max()) if len(values) and values.max() > 0 else None
    values = values[values > 0]
    if not len(values):
        return None
    low, high = np.percentile(values, [1.0, 100.0])
    return max(low / 2.0, high / DECADES), high * 2.0


def colours_by_x(selection: Selection, cases: list[Case]) -> dict[str, Any]:
    """The colours of the cases: numeric values of x are coloured by rank, strings get distinct colours. A reference that has an x
    gets the colour of x, other references are black."""
    if not selection.x:
        return {c.id: style.PALETTE[0] for c in cases}
    values = layout.x_values(selection)
    ranked = [style.sequential(f) for f in np.linspace(0.0, 1.0, len(values))] if layout.is_numeric(selection) else style.distinct(len(values))
    table = dict(zip(values, ranked))
    colours = dict.fromkeys((c.id for c in layout.all_references(selection)), "black")
    return colours | {c.id: table[c.settings[selection.x]] for c in [*layout.all_references(selection), *cases] if selection.x in c.settings}


def colours_in_one_panel(selection: Selection, cases: list[Case]) -> dict[str, Any]:
    """The colours of cases that share a panel: those of x, or different ones if there are several curves. A reference
    has the colour of its first case if there are several, otherwise it is black."""
    if len(layout.groups(selection)) > 1:
        ordinary = [c for c in cases if not c.is_reference]
        colours = dict(zip((c.id for c in ordinary), style.distinct(len(ordinary))))
        several = sum(c.is_reference for c in cases) > 1
        own = {c.reference_id: colours[c.id] for c in reversed(ordinary)} if several else {}
        return {c.id: colours.get(c.id, own.get(c.id, "black")) for c in cases}
    return {**dict.fromkeys((c.id for c in cases), "black"), **colours_by_x(selection, cases)}


def positive(measure: dict[str, Any], case: Case) -> np.ndarray:
    """The values of a measure over time; a logarithmic axis shows only positive values."""
    values = np.array(measure["value"](case), dtype=float)
    if measure.get("log"):
        values[values <= 0] = math.nan
    return values


def panels_of(selection: Selection, measure: dict[str, Any]) -> list[Panel]:
    """One panel per curve with the cases and references that have the measure."""
    panels = [Panel(panel.title, [c for c in panel.drawn if measure["needs"] in c.over_time and len(c.over_time["time"])], [])
              for panel in layout.panels(selection)]
    return [panel for panel in panels if panel.cases]


def x_key(selection: Selection, colours: dict[str, Any]) -> list[Any] | None:
    """The legend of lines whose colour is that of x; None without x."""
    if not selection.x:
        return None
    found = {c.settings[selection.x]: colours[c.id] for c in layout.ordinary(selection)}
    handles = [plt.Line2D([], [], color=found[v], label=labels.setting_text(selection, selection.x, v)) for v in layout.x_values(selection)]
    if any(panel.references for panel in layout.panels(selection)):
        handles.append(plt.Line2D([], [], color="black", linestyle="--", label=layout.reference_name(layout.all_references(selection))))
    return handles


def time_figure(selection: Selection, measure: dict[str, Any]) -> list[Figure]:
    selection = layout.fewer_lines(selection)
    cases = [c for c in layout.ordinary(selection) if measure["needs"] in c.over_time and len(c.over_time["time"])]
    if not cases:
        return []
    colours = colours_by_x(selection, cases)
    charts = time_charts(selection, colours, measure, panels_of(selection, measure))
    marks = key_caption(selection, cases) if measure is MEASURES[0] else " Lines as in the figure of the efficiency over time."
    if not all(layout.repeats(c) for c in cases):
        marks = measure.get("transient", "") + marks
    shown = list(dict.fromkeys(c.id for c in [*cases, *layout.all_references(selection)]))
    return [Figure(chart_figure(charts, 2.3, handles=x_key(selection, colours), sharey=True), measure["name"], measure["title"],
                   measure["caption"] + marks, f"{measure['title']}, one line per case", charts, cases=shown)]


def marked_times(cases: list[Case]) -> tuple[float, list[float]]:
    """The longest part of the runs that is not settled, and the different instants, in ms."""
    after, at = ([1e3 * c.setting("measure", k) for c in cases] for k in ("settled_after_s", "at_s"))
    return max(after), sorted({round(t, 9) for t in at})


def time_marks(cases: list[Case]) -> list[Mark]:
    """The part of the run that is not settled, and the instants."""
    after, instants = marked_times(cases)
    return [*([Mark("band", 0.0, end=after)] if after > 0 else []), *(Mark("line", at) for at in instants)]


def time_charts(selection: Selection, colours: dict[str, Any], measure: dict[str, Any], panels: list[Panel]) -> list[Chart]:
    """The panels with a line per case; the vertical axis shows the settled part."""
    y_limits = limits([c for panel in panels for c in panel.cases], measure)
    return [Chart("time (ms)", answer.column_label(selection, measure["column"]),
                  [Line(warnings_of.label(selection, c, measure["name"]), time_ms(c), positive(measure, c),
                        colours.get(c.id, "black"), c.id, dashed=c.is_reference) for c in panel.cases], panel.title,
                  y_log=bool(measure.get("log")) and y_limits is not None, y_limits=y_limits, marks=time_marks(panel.cases))
            for panel in panels]


def span(values: list[float]) -> str:
    return number(values[0]) + (f" to {number(values[-1])}" if len(values) > 1 else "")


def key_caption(selection: Selection, cases: list[Case]) -> str:
    after = sorted({round(1e3 * c.setting("measure", "settled_after_s"), 6) for c in cases})
    at = sorted({round(1e3 * c.setting("measure", "at_s"), 6) for c in cases})
    text = f" Dotted line: the instant of measure.at_ms ({span(at)} ms)."
    if after[-1] > 0:
        text = (f" Shaded: the part of the run before measure.settled_after_ms ({span(after)} ms).{text} The limits of "
                "the vertical axis follow from the settled part; earlier values may exceed them.")
    if all(layout.repeats(c) for c in cases):
        text = f" One period of the load.{text}"
    if any(selection.reference_of(c) for c in cases):
        text += f" Dashed: {layout.reference_name(layout.all_references(selection))}."
    if selection.x:
        text += f" The colour is the {labels.name(selection, selection.x)}."
    return text


def figures(selection: Selection) -> list[Figure]:
    return [f for m in MEASURES for f in time_figure(selection, m)]
