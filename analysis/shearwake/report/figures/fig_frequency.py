# SPDX-License-Identifier: BSD-3-Clause
"""The dominant frequency at a trace point and the fraction of its energy in bands against x."""
from __future__ import annotations

import math
from dataclasses import dataclass

from matplotlib.axes import Axes

from ... import wake
from .. import answer, labels, layout, style
from ..figure import Figure
from ..load import Selection, traces
from ..validity import invalid_caption
from ..words import listed
from . import fig_curves

NAME = "frequency"


@dataclass
class Band:
    """One panel: a column of u, that of du/dt (empty: none), and its title."""
    column: str
    velocity: str
    title: str

    @property
    def is_share(self) -> bool:
        return bool(self.velocity)


# The perceptible vibration, if the job has no `measure.bands_Hz`.
PERCEIVED = Band("rms_40_400_um", "", "motion within 40 to 400 Hz")


def bands(selection: Selection) -> list[Band]:
    """The bands of the job, else that of perceptible vibration."""
    for case in layout.ordinary(selection):
        edges = case.setting("measure", "bands_Hz", default=[])
        if edges:
            return [Band(f"share_{low:g}_{high:g}_1", f"velocity_share_{low:g}_{high:g}_1",
                         f"energy within {low:g} to {high:g} Hz")
                    for low, high in zip(edges[::2], edges[1::2])]
    return [PERCEIVED]


def peaks(selection: Selection) -> list[tuple[str, str]]:
    """The dominant frequencies that most cases have, as (column, quantity)."""
    cases = layout.ordinary(selection)
    both = [("peak_frequency_Hz", "u"), ("velocity_peak_frequency_Hz", "du/dt")]
    return [(column, of) for column, of in both
            if 2 * sum(not math.isnan(c.value(column, math.nan)) for c in cases) > len(cases)]


def draw_peaks(axes: Axes, selection: Selection, curves: list[tuple[layout.Group, str, str]], column: str, of: str) -> None:
    numeric = layout.is_numeric(selection)
    for (group, colour, marker), aside in zip(curves, fig_curves.asides(selection, curves)):
        fig_curves.draw_curve(axes, selection, group, column, NAME, aside, marker=marker, color=colour,
                              linestyle="-" if numeric else "none")
    labels = fig_curves.reference_lines(axes, selection, curves, column, NAME)
    axes.set_ylabel("frequency (Hz)")
    axes.set_title(f"dominant frequency of {of}", loc="left", color="#555555")
    axes.set_ylim(0.0, 1.15 * axes.get_ylim()[1])
    style.label_right(axes, labels)


def draw_band(axes: Axes, selection: Selection, curves: list[tuple[layout.Group, str, str]], band: Band) -> None:
    """Draws the fraction of u with filled markers, and that of du/dt with open markers and dashed lines."""
    numeric = layout.is_numeric(selection)
    for (group, colour, marker), aside in zip(curves, fig_curves.asides(selection, curves)):
        for column, line, face in ((band.column, "-", colour), (band.velocity, "--", "white")):
            fig_curves.draw_curve(axes, selection, group, column, NAME, aside, marker=marker, color=colour, markersize=5,
                                  markerfacecolor=face, linestyle=line if numeric else "none")
    if band.is_share:  # without references: those of u and du/dt could not be told apart
        axes.set_ylim(-0.02, 1.04)
    else:
        labels = fig_curves.reference_lines(axes, selection, curves, band.column, NAME)
        axes.set_ylim(bottom=0.0)
        style.label_right(axes, labels)
    axes.set_ylabel(answer.column_label(selection, band.column))
    axes.set_title(band.title, loc="left", color="#555555")


def caption(selection: Selection, found: list[tuple[str, str]], shown: list[Band]) -> str:
    places = [traces(c).measured_m for c in layout.recordings(selection) if traces(c)]
    where, text = layout.place_words(places), []
    if found:
        text.append(f"The dominant frequency is that at which the spectrum {where} of "
                    + listed("the displacement u" if of == "u" else "the velocity du/dt"
                             for _, of in found) + " is largest, above one period per run.")
    if shown:
        text.append("The share in a band is that of the energy above one period per run."
                    if shown[0].is_share else
                    f"The motion is the root mean square of u {where} in the band of perceptible vibration.")
        if any(fig_curves.has_any(selection, b.velocity) for b in shown):
            text.append("Filled markers: u. Open markers with dashed lines: du/dt.")
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
    shown = [b for b in bands(selection) if fig_curves.has_any(selection, b.column)]
    if not found and not shown:
        return []
    curves = fig_curves.curves_of(selection)
    figure, made = fig_curves.panels(len(found) + len(shown), curves, height_in=1.75)
    for axes, (column, of) in zip(made, found):
        draw_peaks(axes, selection, curves, column, of)
    for axes, band in zip(made[len(found):], shown):
        draw_band(axes, selection, curves, band)
    fig_curves.set_x_axis(made[-1], selection)
    fig_curves.legend_above(figure, curves)
    parts = ["dominant frequency"] * bool(found)
    if shown:
        parts.append("energy in bands" if shown[0].is_share else "motion that is felt")
    title = f"{' and '.join(parts)} against {labels.name(selection, selection.x)}"
    title = title[:1].upper() + title[1:]
    columns = [*(column for column, _ in found), *(b.column for b in shown)]
    return [Figure(figure, NAME, title, caption(selection, found, shown) + invalid_caption(selection, NAME, *columns), title)]
