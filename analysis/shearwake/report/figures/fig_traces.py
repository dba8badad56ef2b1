# SPDX-License-Identifier: BSD-3-Clause
"""The displacement over time and its spectrum at every trace point."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ...case import Case
from .. import layout, warnings_of
from ..figure import Figure
from ..load import Selection, traces
from ..page.chart import Chart, Line
from ..words import millimetres, some_of
from . import fig_spectra, fig_time
from .chart_figure import chart_figure

POINTS = 12  # largest number of trace points with a row


def places_of(cases: list[Case]) -> tuple[list[tuple[float, float]], int]:
    """The trace points of all cases in mm, nearest to the centre first."""
    found = {tuple(round(1e3 * v, 6) for v in place) for c in cases for place in traces(c).points_m}
    return layout.evenly(sorted(found, key=lambda p: (math.hypot(*p), p)), POINTS), len(found)


def at(case: Case, place: tuple[float, float]) -> tuple[np.ndarray, np.ndarray, np.ndarray] | None:
    """u in um over time, and the frequencies and amplitudes in um, of one trace point; None if it has none."""
    found = traces(case)
    for (x, y), u, amplitude in zip(found.points_m, found.u_z_m, found.amplitude_m):
        if (round(1e3 * x, 6), round(1e3 * y, 6)) == place:
            frequency = found.frequency_Hz
            shown = (frequency > 0) & (frequency <= fig_spectra.SHOWN_Hz)
            return 1e6 * u, frequency[shown], 1e6 * amplitude[shown]
    return None


def title_of(place: tuple[float, float]) -> str:
    return f"x = {millimetres(place[0])} mm, y = {millimetres(place[1])} mm"


def charts_of(cases: list[tuple[Case, str]], places: list[tuple[float, float]], colours: dict[str, Any]) -> list[Chart]:
    """For each point the run and the spectrum."""
    made = []
    for place in places:
        found = [(case, label, values) for case, label in cases if (values := at(case, place))]
        look = [(label, colours[case.id], case.id, case.is_reference) for case, label, _ in found]
        time = [Line(label, fig_time.time_ms(case), u, colour, name, dashed=dashed)
                for (case, _, (u, _, _)), (label, colour, name, dashed) in zip(found, look)]
        spectrum = [Line(label, frequency, amplitude, colour, name, dashed=dashed, dots=layout.repeats(case))
                    for (case, _, (_, frequency, amplitude)), (label, colour, name, dashed) in zip(found, look)]
        made.append(Chart("time (ms)", "$u_z$ (µm)", time, title_of(place)))
        made.append(Chart("frequency (Hz)", "amplitude of $u_z$ (µm)", spectrum, title_of(place)))
    return made


def figures(selection: Selection) -> list[Figure]:
    some = layout.lines_of_one_panel(selection)
    drawn = [c for c in layout.with_references(some) if traces(c)]
    if not drawn:
        return []
    places, every = places_of(drawn)
    colours = fig_time.colours_in_one_panel(some, drawn)
    cases = [(c, warnings_of.label(some, c, "traces")) for c in drawn]
    charts = charts_of(cases, places, colours)
    plane = layout.plane_name(drawn)
    if all(layout.repeats(c) for c in drawn):
        text = (f"Displacement u of {plane} over one period of the load, and the lines of its one-sided amplitude spectrum, "
                "without the mean.")
    else:
        text = (f"Displacement u of {plane} over time, and its one-sided amplitude spectrum over the complete run, without "
                "the mean and with a Hann window.")
    if any(c.is_reference for c in drawn):
        text += f" Dashed: {layout.reference_name(layout.all_references(some))}."
    if len(places) < every:
        text += f" {some_of(len(places), every, 'trace point')}, spread evenly by their distance from the centre."
    title = "Displacement and spectrum at every trace point"
    return [Figure(chart_figure(charts, 1.5, 2, sharex="col"), "traces", title, text, title + ", one line per case", charts,
                   cases=[c.id for c in drawn])]
