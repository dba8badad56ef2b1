# SPDX-License-Identifier: BSD-3-Clause
"""Spectra of the displacement at the trace point of the columns, for all cases and their reference."""
from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from ... import wake
from ...case import Case
from .. import labels, layout, warnings_of
from ..figure import Figure
from ..layout import Panel
from ..load import Selection, amplitude_spectrum, traces
from ..page.chart import Chart, Line, Mark
from ...keys import split_unit
from ..words import listed, millimetres, number
from . import fig_frequency, fig_time
from .chart_figure import chart_figure

SHOWN_Hz, VELOCITY_Hz = 1000.0, 2000.0  # upper limits of the frequency axis for u and du/dt
SEEN = 0.02  # smallest visible amplitude relative to the largest
UNLIKE = 3.0  # largest ratio of the largest amplitudes of panels with a common scale
MODULATIONS = ("am_frequency", "sm_frequency", "draw_frequency")


def own_frequency_Hz(selection: Selection, case: Case) -> float:
    """The modulation frequency of the case if x is a modulation frequency, else NaN."""
    name, unit = split_unit(selection.x or "")
    factor = {"Hz": 1.0, "kHz": 1e3}.get(unit)
    value: Any = case.settings.get(selection.x)
    if name not in MODULATIONS or factor is None or not layout.is_number(value):
        return math.nan
    return factor * value


def spectrum(case: Case) -> tuple[np.ndarray, np.ndarray]:
    """The spectrum without the mean, which would look like a step in a one-sided spectrum."""
    found = traces(case)
    shown = found.frequency_Hz > 0
    return found.frequency_Hz[shown], found.amplitude_m[found.measured, shown]


def unit_of(cases: list[Case]) -> tuple[str, float]:
    """Unit and factor of the amplitudes: nm below 1 um, else um."""
    largest = max(np.nanmax(spectrum(c)[1], initial=0.0) for c in cases)
    return ("µm", 1e6) if largest >= 1e-6 else ("nm", 1e9)


def velocity_spectrum(case: Case) -> Any:
    """One-sided spectrum of du/dt at the trace point of the columns in Hz and mm/s. The skin is at rest at t = 0 or, in the
    periodic regime, moves as at the end of the period."""
    u = traces(case).u_z_m[traces(case).measured]
    interval_s = float(case.over_time["time"][1] - case.over_time["time"][0])
    velocity = np.diff(u, prepend=0.0) / interval_s
    if layout.repeats(case):
        velocity[0] = (u[0] - u[-1]) / interval_s
        return np.fft.rfftfreq(len(velocity), interval_s)[1:], 2e3 * np.abs(np.fft.rfft(velocity))[1:] / len(velocity)
    frequency, amplitude = amplitude_spectrum(velocity, interval_s)
    return frequency[1:], 1e3 * amplitude[1:]


def plain_of(selection: Selection, case: Case) -> Case | None:
    """The case with which a case is compared: its reference, or STM in a sweep over the modulation. A
    reference and STM are compared with themselves. None if there is no such case."""
    if reference := selection.reference_of(case):
        return reference
    if case.is_reference or kind_of(case) == "STM":
        return case
    same = {k: v for k, v in case.settings.items() if "modulation" not in k or "speed_m_s" in k}
    return next((c for c in layout.ordinary(selection) if kind_of(c) == "STM"
                 and all(c.settings.get(k) == v for k, v in same.items())), None)


def kind_of(case: Case) -> str:
    return case.setting("load", "modulation", "kind", default="")


def largest(case: Case | None) -> float:
    return float(np.nanmax(spectrum(case)[1], initial=0.0)) if case and traces(case) else 0.0


def panels_of(selection: Selection) -> list[Panel]:
    """The panels that contain a spectrum."""
    panels = [Panel(panel.title, [c for c in panel.cases if traces(c)],
                    [r for r in panel.references if traces(r)]) for panel in layout.panels(selection)]
    return [panel for panel in panels if panel.cases]


def highest(curves: list[tuple[np.ndarray, np.ndarray]], own_Hz: list[float], end_Hz: float) -> float:
    """The end of the frequency axis: a half or a quarter of the range if all curves and the modulation
    frequencies of the cases fit, else the range."""
    above = max((f for f in own_Hz if f <= end_Hz), default=0.0)
    for frequency, values in curves:
        seen = frequency[values > SEEN * np.nanmax(values)]
        above = max(above, seen[seen <= end_Hz].max(initial=0.0))
    return next((part * end_Hz for part in (0.25, 0.5) if above < 0.9 * part * end_Hz), end_Hz)


def draw_panels(selection: Selection, panels: list[Panel], label: str, curve_of: Callable[..., Any], end_Hz: float = SHOWN_Hz,
                peaks: bool = False) -> tuple[Any, bool, list[Chart]]:
    """`curve_of(case)` returns frequencies and values; `peaks` marks the largest value. Returns the figure, whether its panels share
    their scale, and their charts."""
    cases = [c for panel in panels for c in panel.cases]
    colours = fig_time.colours_by_x(selection, cases)
    tops = [max(np.nanmax(curve_of(c)[1], initial=0.0) for c in panel.drawn) for panel in panels]
    alike = bool(max(tops) <= UNLIKE * min(tops))
    shown_Hz = highest([curve_of(c) for c in cases], [own_frequency_Hz(selection, c) for c in cases], end_Hz)
    charts = []
    for panel, top in zip(panels, tops):
        lines = []
        for case in panel.drawn:
            frequency, values = (values[curve_of(case)[0] <= shown_Hz] for values in curve_of(case))
            lines.append(Line(warnings_of.label(selection, case, "spectra"), frequency, values,
                              colours.get(case.id, "black"), case.id, dashed=case.is_reference,
                              dots=layout.repeats(case)))
        top = max(tops) if alike else top
        charts.append(Chart("frequency (Hz)", label, lines, panel.title, y_limits=(0.0, 1.06 * top) if top > 0.0 else None,
                            marks=panel_marks(selection, panel.cases, colours, curve_of, shown_Hz, peaks)))
    figure = chart_figure(charts, 3.4 if len(panels) == 1 else 2.3, handles=fig_time.x_key(selection, colours), sharey=alike)
    return figure, alike, charts


def panel_marks(selection: Selection, cases: list[Case], colours: dict[str, Any], curve_of: Callable[..., Any], end_Hz: float,
                peaks: bool) -> list[Mark]:
    """The band of the table, the modulation frequencies of the cases, and the largest values."""
    marks = [Mark("band", low, end=min(high, end_Hz)) for low, high in bands(cases)]
    for case in cases:
        own = own_frequency_Hz(selection, case)
        if own <= end_Hz:
            marks.append(Mark("tick", own, colour=colours[case.id], case=case.id))
        if peaks:
            frequency, values = curve_of(case)
            top = int(np.nanargmax(values))
            marks.append(Mark("dot", float(frequency[top]), y=float(values[top]), colour=colours[case.id], case=case.id))
    return marks


def bands(cases: list[Case]) -> list[Any]:
    """The band of `measure.bands_Hz` in Hz if all cases have the same single band, else none."""
    edges = {tuple(c.setting("measure", "bands_Hz", default=())) for c in cases}
    return [edges.pop()] if len(edges) == 1 and len(next(iter(edges))) == 2 else []


def relative_figure(selection: Selection, panels: list[Panel]) -> Figure | None:
    """Spectra relative to the largest amplitude of plain STM; None if a case has no reference or if the foci
    of the references do not pass the point."""
    drawn = [c for panel in panels for c in panel.cases]
    plain = {c.id: plain_of(selection, c) for c in drawn}
    references = [c for c in plain.values() if c and largest(c)]
    if (len(references) < len(plain) or all(plain[c.id] is c for c in drawn)
            or not all(wake.is_passed(c, *traces(c).measured_m) for c in references)):
        return None
    name = layout.reference_name(references)

    def relative(case: Case) -> tuple[np.ndarray, np.ndarray]:
        frequency, amplitude = spectrum(case)
        return frequency, amplitude / largest(plain.get(case.id, case))

    figure, _, charts = draw_panels(selection, panels, f"amplitude / largest of {name}", relative)
    text = (f"The spectra above, without the mean, relative to the largest amplitude of {name} under the same conditions. They show "
            "how much of the strength each case preserves, and at which frequencies.")
    return Figure(figure, "spectra_relative", f"Spectra relative to {name}", text,
                  f"Amplitude spectra relative to the largest amplitude of {name}, one line per case", charts)


def velocity_figure(selection: Selection, panels: list[Panel]) -> Figure | None:
    """Spectra of du/dt if du/dt has a dominant frequency and u has none, else None."""
    if [of for _, of in fig_frequency.peaks(selection)] != ["du/dt"]:
        return None
    if not all(traces(c) for panel in panels for c in panel.cases):
        return None
    figure, alike, charts = draw_panels(selection, panels, "amplitude of $du_z/dt$ (mm/s)", velocity_spectrum, VELOCITY_Hz, peaks=True)
    how = "" if all(layout.repeats(c) for panel in panels for c in panel.cases) else ", without its mean and with a Hann window"
    text = (f"Spectra of the velocity du/dt{how}; a dot marks the dominant frequency, at which the amplitude is "
            f"largest.{own_scale(alike)}")
    where = layout.place_words(traces(c).measured_m for panel in panels for c in panel.cases)
    return Figure(figure, "spectra_velocity", f"Spectra of the velocity {where}", text,
                  "Amplitude spectra of the velocity at one point, one line per case", charts)


def own_scale(alike: bool) -> str:
    return "" if alike else " Each panel has its own scale."


def figures(selection: Selection) -> list[Figure]:
    selection = layout.fewer_lines(selection)
    cases = [c for c in layout.ordinary(selection) if traces(c)]
    panels = panels_of(selection)
    if not cases or not panels:
        return []
    unit, factor = unit_of(cases + [r for r in layout.all_references(selection) if traces(r)])

    def shown(case: Case) -> tuple[np.ndarray, np.ndarray]:
        frequency, amplitude = spectrum(case)
        return frequency, factor * amplitude

    figure, alike, charts = draw_panels(selection, panels, f"amplitude of $u_z$ ({unit})", shown)
    text = caption(selection, cases) + own_scale(alike)
    where = layout.place_words(traces(c).measured_m for c in cases)
    made = [Figure(figure, "spectra", f"Spectra {where}", text, "Amplitude spectra of the displacement "
                   "at one point, one line per case", charts),
            velocity_figure(selection, panels), relative_figure(selection, panels)]
    ids = [c.id for panel in panels for c in panel.drawn]
    return [replace(f, cases=ids) for f in made if f]


def caption(selection: Selection, cases: list[Case]) -> str:
    places = sorted({tuple(millimetres(1e3 * v) for v in traces(c).measured_m) for c in cases})
    duration = {round(c.over_time["time"][-1], 9) for c in cases}
    where = listed(f"({x}, {y}) mm" for x, y in places)
    where += "" if (plane := layout.plane_name(cases)) == "the surface" else f" in {plane}"
    if all(layout.repeats(c) for c in cases):
        text = f"One-sided amplitude of u at {where}: the lines at the multiples of 1 / period of the load."
    else:
        text = f"One-sided amplitude of u at {where} over the complete run, without its mean and with a Hann window."
    if len(duration) == 1 and not any(layout.repeats(c) for c in cases):
        run = duration.pop()
        text += f" The run of {number(1e3 * run)} ms resolves frequencies {number(2 / run, 2)} Hz apart."
    passing = {number(t, 3) if (t := wake.passing_ms(c, *traces(c).measured_m)) is not None else None for c in cases}
    if len(passing) == 1 and None not in passing and not any(layout.repeats(c) for c in cases):
        text += f" The focus passes this point once, at {passing.pop()} ms, so the curves show a single passage."
        if any(kind_of(c) != "STM" for c in cases):
            text += " Their heights depend on the phase of the modulation at that time."
    if any(not math.isnan(own_frequency_Hz(selection, c)) for c in cases):
        text += f" Ticks on the axis: the {labels.name(selection, selection.x)} of each case."
    if bands(cases):
        low, high = bands(cases)[0]
        text += f" Grey: {number(low)} to {number(high)} Hz, the band of the share in the table."
    if references := layout.all_references(selection):
        text += f" Dashed: {layout.reference_name(references)}."
    return text
