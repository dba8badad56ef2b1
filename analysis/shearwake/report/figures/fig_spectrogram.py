# SPDX-License-Identifier: BSD-3-Clause
"""Spectrograms of u at the trace points: its frequencies over time."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ... import wake
from ...case import Case
from .. import layout, references, style, warnings_of
from ..figure import Figure
from ..load import Selection, traces
from ..page import hover
from ..words import millimetres, number

SHOWN_Hz = 1000.0
CASES, POINTS = 4, 3
LOWEST_dB = -40.0
WINDOWS = 3.0  # length of the run over that of a window: balances resolution in time and frequency
LEAST = 32  # smallest number of samples for a spectrogram


def spectrogram(u: np.ndarray, interval_s: float, window: int, repeats: bool = False) -> tuple[np.ndarray, np.ndarray,
                np.ndarray]:
    """Times in s, frequencies in Hz, and amplitude of u (frequency, time), computed with Hann windows after
    subtraction of their means. Windows may start before the load, since the skin is at rest then, but end
    within the run. If u repeats, the previous and the next period surround it."""
    shape = np.hanning(window + 2)[1:-1]
    before = window // 2
    u = np.concatenate([u[-before:], u, u[:window - before]]) if repeats else np.concatenate([np.zeros(before), u])
    starts = np.arange(0, len(u) - window + 1, max(1, (len(u) - window) // 200))
    parts = np.stack([u[s: s + window] for s in starts])
    parts = (parts - parts.mean(axis=1, keepdims=True)) * shape
    padded = max(4 * window, 512)  # for a smooth picture
    amplitude = 2.0 * np.abs(np.fft.rfft(parts, n=padded, axis=1)).T / shape.sum()
    times = (starts - before + 0.5 * (window - 1) + 1.0) * interval_s
    return times, np.fft.rfftfreq(padded, interval_s), amplitude


def chosen(selection: Selection) -> list[Case]:
    """The reference, then cases from the first to the last curve."""
    return [c for c in references.first_and_last(selection, CASES) if traces(c) and len(c.over_time["time"]) >= LEAST]


def points(case: Case) -> list[tuple[tuple[float, float], np.ndarray]]:
    """The trace points nearest to the centre, nearest first."""
    return sorted(zip(traces(case).points_m, traces(case).u_z_m), key=lambda trace: math.hypot(*trace[0]))[:POINTS]


def compute(case: Case) -> list[Any]:
    time = case.over_time["time"]
    interval_s = float(time[1] - time[0])
    window = max(8, round(len(time) / WINDOWS))
    return [(at, *spectrogram(u, interval_s, window, layout.repeats(case))) for at, u in points(case)]


def window_words(cases: list[Case]) -> str:
    times = [c.over_time["time"] for c in cases]
    lengths_s = sorted(max(8, round(len(time) / WINDOWS)) * float(time[1] - time[0]) for time in times)
    if lengths_s[-1] > 1.01 * lengths_s[0]:
        return (f"The Hann window is a third of the time shown, {number(1e3 * lengths_s[0], 3)} to "
                f"{number(1e3 * lengths_s[-1], 3)} ms, and resolves frequencies about {number(2.0 / lengths_s[-1], 2)} to "
                f"{number(2.0 / lengths_s[0], 2)} Hz apart")
    return (f"The Hann window of {number(1e3 * lengths_s[0], 3)} ms resolves frequencies about "
            f"{number(2.0 / lengths_s[0], 2)} Hz apart")


def figures(selection: Selection) -> list[Figure]:
    cases = chosen(selection)
    if not cases:
        return []
    every = [compute(c) for c in cases]
    peaks = {c.id: max(a.max() for _, _, _, a in row) for c, row in zip(cases, every)}
    if not min(peaks.values()) > 0:
        return []
    columns = max(map(len, every))
    if columns == 1:  # two cases side by side
        cells = [(c, *row[0]) for c, row in zip(cases, every)]
        columns = min(2, len(cells))
    else:
        cells = [(c, *cell) for c, row in zip(cases, every) for cell in row]
    rows = math.ceil(len(cells) / columns)
    ends = {round(float(c.over_time["time"][-1]), 9) for c in cases}
    alike = len(ends) == 1 or not any(layout.repeats(c) for c in cases)
    figure, made = style.panels(len(cells), columns, 1.7 if rows > 1 else 2.6, 0.8, sharex=alike, sharey=True)
    for axes, (case, at, times, frequency, amplitude) in zip(made.flat, cells):
        level = 20 * np.log10(np.maximum(amplitude / peaks[case.id], 1e-9))
        edges = wake.extent(1e3 * times, frequency)
        image = axes.imshow(level, extent=edges, origin="lower", aspect="auto", vmin=LOWEST_dB,
                            vmax=0.0, cmap=style.sequential_map(), interpolation="bilinear")
        axes.set_ylim(0.0, min(SHOWN_Hz, frequency[-1]))
        hover.attach(axes, level, edges[:2], edges[2:], "amplitude", "t (ms)", "f (Hz)", "dB")
        axes.grid(False)
        place = "" if columns == 1 or len(points(case)) == 1 else (
            f" at ({millimetres(1e3 * at[0])}, {millimetres(1e3 * at[1])}) mm")
        title = layout.wrapped(warnings_of.label(selection, case, "spectrograms") + place, 6.6 / columns)
        axes.set_title(title, loc="left", fontsize=8.5)
    for i in range(len(cells)):
        made.flat[i].tick_params(labelbottom=not alike or i + columns >= len(cells))
    figure.supxlabel("time (ms)", fontsize=9.5)
    figure.supylabel("frequency (Hz)", fontsize=9.5)
    style.bar_beside(figure, image, list(made.flat), "amplitude of $u_z$ (dB)", aspect=30, pad=0.02, extend="min")
    text = ("Amplitude of u over time and frequency; 0 dB is the largest amplitude of each case over its "
            f"points. {window_words(cases)}; the mean of each window is subtracted.")
    where = {at for case in cases for at, _ in points(case)}
    if len(where) == 1:
        x, y = where.pop()
        text += f" At ({millimetres(1e3 * x)}, {millimetres(1e3 * y)}) mm."
    return [Figure(figure, "spectrograms", "Spectrograms at the trace points", text,
                   "Amplitude of the displacement over time and frequency, one panel per case",
                   cases=[case.id for case in cases])]
