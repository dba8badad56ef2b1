# SPDX-License-Identifier: BSD-3-Clause
"""The measures that are drawn against the swept key, and their captions."""
from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ... import wake
from .. import answer, labels, layout, style
from ..figure import Figure
from ..load import Selection
from ..page.chart import Chart, Line
from ..page.curve_chart import curve_chart, draw_errors, error_caption, errors
from ..validity import invalid_caption
from ..words import number
from . import fig_curves as curves_module, fig_heat

MEASURES: list[dict[str, Any]] = [
    {"name": "eta", "title": "Reconstruction efficiency against {x}",
     "period": "eta_period_1", "instant": "eta_at_1",
     "caption": "η is the fraction of Σu² of {region} that lies within the focal disc. The larger η is, "
                "the better the vibration is confined to the focus."},
    {"name": "ipr_abs", "title": "Spread of the vibration (IPR of |u|) against {x}",
     "period": "ipr_abs_period_mm2", "instant": "ipr_abs_at_mm2",
     "caption": "The area over which the displacement is spread, (Σ|u|)²/Σu² times the area of a cell. Weak, "
                "widespread waves contribute strongly."},
    {"name": "participation", "title": "Participation area against {x}",
     "period": "participation_period_mm2", "instant": "participation_at_mm2",
     "caption": "The area over which the energy is spread, (Σu²)²/Σu⁴ times the area of a cell. Spots of strong "
                "vibration contribute most."},
    {"name": "ipr", "title": "Inverse participation ratio of the thesis against {x}",
     "period": "ipr_period_mm2", "instant": "ipr_at_mm2", "log": True,
     "caption": "(Σu)²/Σu², as the thesis defines it, measures compressibility, not spread: nearly incompressible tissue conserves "
                "its volume, so Σu is close to zero and the value is very small for any pattern. Use the two areas "
                "above to compare the spread."},
]


SHARPNESS: dict[str, Any] = {
    "name": "sharpness", "title": "Sharpness of the drawn shape against {x}",
    "period": "sharpness_1", "instant": None,
    "caption": "The fraction of the time-averaged energy within one FWHM of the shape that the focus draws."}

PERCEIVED: dict[str, Any] = {
    "name": "felt", "title": "Level of sensation against {x}",
    "period": "felt_path_dB", "instant": None,
    "caption": "The mean over the drawn shape of the level of the acceleration above the threshold of perception. The skin feels "
               "nothing below 0 dB, and a difference of 2.3 dB is just noticeable."}


def draw_column(axes: Axes, selection: Selection, curves: list[tuple[layout.Group, str, str]], column: str,
                figure: str) -> None:
    """Draws one column of the table with its error bars, one line per curve, as a part of the figure of this name."""
    for (group, colour, marker), aside in zip(curves, curves_module.asides(selection, curves)):
        x, y = curves_module.draw_curve(axes, selection, group, column, figure, aside, marker=marker, color=colour,
                                        linestyle="-" if layout.is_numeric(selection) else "none")
        draw_errors(axes, x, y, group.cases, column, colour)
    axes.margins(y=0.12)
    curves_module.widen(axes)


def drawn_values(selection: Selection, column: str) -> np.ndarray:
    """The values of a column with their error bars."""
    values = np.array([c.value(column, math.nan) for c in layout.ordinary(selection)])
    half = np.nan_to_num(errors(layout.ordinary(selection), column))
    return np.concatenate([values, np.where(half < values, values - half, values), values + half])


def ratio_curves(selection: Selection, column: str, name: str) -> tuple[Any, list[Chart]]:
    """One panel with a measure relative to the reference on a logarithmic scale around 1: the picture and its chart."""
    curves = [curve for curve in curves_module.curves_of(selection) if any(selection.reference_of(c) is not c for c in curve[0].cases)]
    figure, (axes,) = curves_module.panels(1, curves, height_in=2.6)
    draw_column(axes, selection, curves, selection.ratio_of(column), name)
    axes.axhline(1.0, color=style.INK, linestyle="--", linewidth=1.3, zorder=1.5)
    limits = style.ratio_limits(drawn_values(selection, selection.ratio_of(column)))
    if limits:
        axes.set_yscale("log")
        axes.set_ylim(*limits)
        style.ratio_axis(axes.yaxis, limits)
    axes.set_ylabel(answer.column_label(selection, selection.ratio_of(column)))
    reference = layout.reference_name(layout.all_references(selection))
    style.label_right(axes, [(1.0, reference, style.INK)])
    curves_module.set_x_axis(axes, selection)
    curves_module.legend_above(figure, curves)
    chart = curve_chart(selection, name, selection.ratio_of(column))
    x = sorted({layout.x_position(selection, c) for c in layout.ordinary(selection)})
    if limits:
        chart.y_log, chart.y_limits, chart.y_ticks = True, limits, style.ratio_ticks(limits)
    chart.lines.append(Line(reference, x, [1.0] * len(x), style.INK, dashed=True))
    return figure, [chart]


def gain_figure(selection: Selection) -> Figure | None:
    """eta relative to that of the reference, both as means over periods."""
    if not selection.x or not curves_module.has_any(selection, selection.ratio_of("eta_period_1")):
        return None
    name = layout.reference_name(layout.all_references(selection))
    figure, charts = ratio_curves(selection, "eta_period_1", "gain")
    title = f"Efficiency relative to {name} against {labels.name(selection, selection.x)}"
    within = "in the same medium" if curves_module.is_steady(selection) else "in the same time window and medium"
    return Figure(figure, "gain", title, f"η over complete periods relative to that of {name} {within}, which is the dashed line at 1. Above "
                  f"it, a case keeps a larger fraction of the energy at the focus than {name} does."
                  + error_caption(selection, selection.ratio_of("eta_period_1"))
                  + invalid_caption(selection, "gain", selection.ratio_of("eta_period_1")), title, charts)


def strength_figure(selection: Selection) -> Figure | None:
    """rms over the focal disc relative to the reference; None without a reference."""
    if not selection.x or not layout.all_references(selection) or not curves_module.has_any(selection, "focal_rms_um"):
        return None
    title = f"Strength at the focus against {labels.name(selection, selection.x)}"
    name = layout.reference_name(layout.all_references(selection))
    figure, charts = ratio_curves(selection, "focal_rms_um", "strength")
    caption = (f"The rms of u over the focal disc and {curves_module.period_words(selection)}, relative to {name}, the dashed "
               "line at 1." + impulse_caption(selection, name) + error_caption(selection, selection.ratio_of("focal_rms_um"))
               + invalid_caption(selection, "strength", selection.ratio_of("focal_rms_um")))
    return Figure(figure, "strength", title, caption, title, charts)


DISPLACEMENT = [("focal_rms_um", "rms over the focal disc"), ("peak_um", "largest displacement")]


def displacement_figure(selection: Selection) -> Figure | None:
    """The rms over the focal disc and the peak in micrometres."""
    rows = [row for row in DISPLACEMENT if curves_module.has_any(selection, row[0])]
    if not selection.x or not rows:
        return None
    curves = curves_module.curves_of(selection)
    figure, made = curves_module.panels(len(rows), curves)
    for axes, (column, title) in zip(made, rows):
        draw_column(axes, selection, curves, column, "displacement")
        style.label_right(axes, curves_module.reference_lines(axes, selection, curves, column, "displacement"))
        axes.set_ylabel(answer.column_label(selection, column))
        axes.set_title(title, loc="left", color="#555555")
    curves_module.set_x_axis(made[-1], selection)
    curves_module.legend_above(figure, curves)
    title = f"Displacement in µm against {labels.name(selection, selection.x)}"
    words = {"focal_rms_um": f"rms of u over the focal disc and {curves_module.period_words(selection)}.",
             "peak_um": "largest |u| within one period." if curves_module.is_steady(selection) else
             "largest |u| from the start of the run to the instant measure.at_ms."}
    starts = ("Above: the", "Below: the") if len(rows) == 2 else ("The",)
    caption = " ".join(f"{start} {words[column]}" for start, (column, _) in zip(starts, rows))
    if layout.added_references(selection):
        caption += f" Dashed lines: {layout.reference_name(layout.added_references(selection))}."
    columns = [row[0] for row in rows]
    caption += error_caption(selection, *columns) + invalid_caption(selection, "displacement", *columns)
    return Figure(figure, "displacement", title, caption, title, [curve_chart(selection, "displacement", *row) for row in rows])


def impulse_caption(selection: Selection, name: str) -> str:
    """States the impulse relative to the reference, since half the mean force halves the displacement."""
    shares = [c.value("impulse_mN_ms", math.nan) / full for c in layout.ordinary(selection)
              if (r := selection.reference_of(c)) and (full := r.value("impulse_mN_ms", math.nan))]
    shares = [s for s in shares if not math.isnan(s)]
    if not shares or (min(shares) > 0.99 and max(shares) < 1.01):
        return ""
    low, high = number(min(shares), 2), number(max(shares), 2)
    amount = low if low == high else f"{low} to {high}"
    return f" The impulse on the skin (mean force times time) is {amount} times that of {name}."


def figures(selection: Selection) -> list[Figure]:
    if len(layout.groups(selection)) > style.CURVES and fig_heat.plane(selection):
        return []  # drawn as small multiples and heat maps instead
    made = [curves_module.measure_figure(selection, m) for m in MEASURES[:1]]
    made += [gain_figure(selection), strength_figure(selection),
             displacement_figure(selection)]
    if not all(map(wake.runs_straight_on, layout.ordinary(selection))):
        made.append(curves_module.measure_figure(selection, SHARPNESS))
    if curves_module.has_any(selection, PERCEIVED["period"]):
        made.append(curves_module.measure_figure(selection, PERCEIVED))
    made += [curves_module.measure_figure(selection, m) for m in MEASURES[1:]]
    return [f for f in made if f]
