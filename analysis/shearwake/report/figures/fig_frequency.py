# SPDX-License-Identifier: BSD-3-Clause
"""The dominant frequency at a trace point and the fraction of its energy in bands against x."""
from __future__ import annotations

import math

from ... import wake
from .. import labels, layout, style
from ..figure import Figure
from ..load import Selection, traces
from ..page.curve_chart import curve_chart
from ..words import listed
from . import fig_curves

NAME = "frequency"
PERCEIVED = "rms_40_400_um"  # the perceptible vibration, if the job has no `measure.bands_Hz`


def bands(selection: Selection) -> dict[str, str]:
    """The columns of the bands of the job with their titles, else that of perceptible vibration."""
    for case in layout.ordinary(selection):
        edges = case.setting("measure", "bands_Hz", default=[])
        if edges:
            return {f"{start}share_{low:g}_{high:g}_1": f"energy of {of} within {low:g} to {high:g} Hz"
                    for low, high in zip(edges[::2], edges[1::2]) for start, of in (("", "u"), ("velocity_", "du/dt"))}
    return {PERCEIVED: "motion within 40 to 400 Hz"}


def peaks(selection: Selection) -> list[tuple[str, str]]:
    """The dominant frequencies that most cases have, as (column, quantity)."""
    cases = layout.ordinary(selection)
    both = [("peak_frequency_Hz", "u"), ("velocity_peak_frequency_Hz", "du/dt")]
    return [(column, of) for column, of in both
            if 2 * sum(not math.isnan(c.value(column, math.nan)) for c in cases) > len(cases)]


def caption(selection: Selection, found: list[tuple[str, str]], shown: dict[str, str]) -> str:
    places = [traces(c).measured_m for c in layout.recordings(selection) if traces(c)]
    where, text = layout.place_words(places), []
    if found:
        text.append(f"The dominant frequency is that at which the spectrum {where} of "
                    + listed("the displacement u" if of == "u" else "the velocity du/dt"
                             for _, of in found) + " is largest, above one period per run.")
    if shown:
        text.append(f"The motion is the root mean square of u {where} in the band of perceptible vibration." if PERCEIVED in shown else
                    "The share in a band is that of the energy above one period per run.")
    if "u" not in [of for _, of in found] and found:
        text.append("In most cases the spectrum of u is largest at 0 Hz, so that u has no dominant frequency.")
    kinds = {c.setting("load", "modulation", "kind", default="") for c in layout.ordinary(selection)}
    if kinds != {"STM"} and all(wake.passing_ms(c, *traces(c).measured_m) is not None for c in layout.recordings(selection)):
        point = "the centre" if where == "at the centre" else "this point"
        text.append(f"The focus passes {point} once, so the values describe a single passage and depend on the "
                    "phase of the modulation at that time.")
    return " ".join(text)


def figures(selection: Selection) -> list[Figure]:
    if not selection.x or len(layout.groups(selection)) > style.CURVES:
        return []
    found = peaks(selection)
    shown = {column: title for column, title in bands(selection).items() if fig_curves.has_any(selection, column)}
    if not found and not shown:
        return []
    charts = {column: curve_chart(selection, NAME, column, f"dominant frequency of {of}") for column, of in found}
    charts |= {column: curve_chart(selection, NAME, column, title) for column, title in shown.items()}
    for chart in charts.values():
        chart.begin_at_zero()
    parts = ["dominant frequency"] * bool(found)
    if shown:
        parts.append("motion that is felt" if PERCEIVED in shown else "energy in bands")
    title = f"{' and '.join(parts)} against {labels.name(selection, selection.x)}"
    return [fig_curves.curves_figure(selection, NAME, title[:1].upper() + title[1:], charts, caption(selection, found, shown), 1.75)]
