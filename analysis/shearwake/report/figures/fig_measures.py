# SPDX-License-Identifier: BSD-3-Clause
"""The measures that are drawn against the swept key, and their captions."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ... import wake
from .. import labels, layout, style
from ..figure import Figure
from ..load import Selection
from ..page.chart import Chart, Line
from ..page.curve_chart import curve_chart, errors
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


def drawn_values(selection: Selection, column: str) -> np.ndarray:
    """The values of a column with their error bars."""
    values = np.array([c.value(column, math.nan) for c in layout.ordinary(selection)])
    half = np.nan_to_num(errors(layout.ordinary(selection), column))
    return np.concatenate([values, np.where(half < values, values - half, values), values + half])


def ratio_chart(selection: Selection, column: str, name: str) -> dict[str, Chart]:
    """The panel of a measure relative to the reference, on a logarithmic scale around 1."""
    ratio = selection.ratio_of(column)
    chart = curve_chart(selection, name, ratio)
    if limits := style.ratio_limits(drawn_values(selection, ratio)):
        chart.y_log, chart.y_limits, chart.y_ticks = True, limits, style.ratio_ticks(limits)
    x = sorted({layout.x_position(selection, c) for c in layout.ordinary(selection)})
    chart.lines.append(Line(layout.reference_name(layout.all_references(selection)), x, [1.0] * len(x), style.INK, dashed=True))
    return {ratio: chart}


def gain_figure(selection: Selection) -> Figure | None:
    """eta relative to that of the reference, both as means over periods."""
    if not selection.x or not curves_module.has_any(selection, selection.ratio_of("eta_period_1")):
        return None
    name = layout.reference_name(layout.all_references(selection))
    within = "in the same medium" if curves_module.is_steady(selection) else "in the same time window and medium"
    return curves_module.curves_figure(
        selection, "gain", f"Efficiency relative to {name} against {labels.name(selection, selection.x)}",
        ratio_chart(selection, "eta_period_1", "gain"),
        f"η over complete periods relative to that of {name} {within}, which is the dashed line at 1. Above it, a case keeps a larger "
        f"fraction of the energy at the focus than {name} does.")


def strength_figure(selection: Selection) -> Figure | None:
    """rms over the focal disc relative to the reference; None without a reference."""
    if not selection.x or not layout.all_references(selection) or not curves_module.has_any(selection, "focal_rms_um"):
        return None
    name = layout.reference_name(layout.all_references(selection))
    return curves_module.curves_figure(
        selection, "strength", f"Strength at the focus against {labels.name(selection, selection.x)}",
        ratio_chart(selection, "focal_rms_um", "strength"),
        f"The rms of u over the focal disc and {curves_module.period_words(selection)}, relative to {name}, the dashed line at 1."
        + impulse_caption(selection, name))


def displacement_figure(selection: Selection) -> Figure | None:
    """The rms over the focal disc and the peak in micrometres."""
    words = {"focal_rms_um": ("rms over the focal disc", f"rms of u over the focal disc and {curves_module.period_words(selection)}."),
             "peak_um": ("largest displacement", "largest |u| within one period." if curves_module.is_steady(selection) else
                         "largest |u| from the start of the run to the instant measure.at_ms.")}
    charts = {column: curve_chart(selection, "displacement", column, title) for column, (title, _) in words.items()
              if selection.x and curves_module.has_any(selection, column)}
    if not charts:
        return None
    starts = ("Above: the", "Below: the") if len(charts) == 2 else ("The",)
    caption = " ".join(f"{start} {words[column][1]}" for start, column in zip(starts, charts))
    if layout.added_references(selection):
        caption += f" Dashed lines: {layout.reference_name(layout.added_references(selection))}."
    return curves_module.curves_figure(selection, "displacement", f"Displacement in µm against {labels.name(selection, selection.x)}", charts,
                                       caption)


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
