# SPDX-License-Identifier: BSD-3-Clause
"""Time-averaged intensity and level of sensation of the surface, with the shape that the focus draws."""
from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ... import wake
from ...case import Case
from .. import layout, load, style, warnings_of
from ..figure import Figure
from ..words import number
from . import fig_surface


def draw_lines(axes: Axes, lines: list[np.ndarray]) -> None:
    for line in lines:
        axes.plot(*(1e3 * line).T, color="white", linewidth=0.9, linestyle=(0, (3, 2)),
                  marker="+" if len(line) == 1 else "", path_effects=style.halo(1.8, "black"))


def shots_of(selection: load.Selection, read: Callable[..., Any], value: Callable[..., Any] = lambda values: values) -> tuple[list[Any], int]:
    """What `read` finds of the cases of the panels of the surface, as snapshots, and the number of columns."""
    cells, columns = fig_surface.cells(selection)
    return [fig_surface.Snapshot(c, c.focus["time"][-1], 1e3 * m[0], 1e3 * m[1], value(m[2])) if c and (m := read(c)) else None
            for c in cells], columns


def picture(selection: load.Selection, panels: tuple[list[Any], int], limits: Any, ends: tuple[float, float], label: str,
            note: Callable[..., str], levels: bool = False, **look: Any) -> Any:
    """Maps on the same colour scale with the drawn shape, and for levels of sensation their threshold."""
    figure, made, bar_axes = fig_surface.arrange(selection, *panels, limits)
    for axes, shot in zip(made, panels[0]):
        if not shot:
            continue
        image = axes.imshow(shot.u_um.T, origin="lower", cmap="magma", vmin=ends[0], vmax=ends[1], extent=fig_surface.extent(shot), **look)
        if levels and (found := load.levels(shot.case)):
            axes.set_facecolor("0.4")  # outside the measured region
            fig_surface.draw_threshold(axes, found, "white")
        mean = load.mean_square(shot.case)
        draw_lines(axes, mean[3] if mean else [])
        fig_surface.frame(axes, limits)
        what, unit = ("level", "dB") if levels else ("rms of u", "µm")
        fig_surface.attach_values(axes, shot.x_mm, shot.y_mm, shot.u_um, limits, what, unit)
        if warnings_of.is_valid(shot.case) and (text := note(shot.case)):
            fig_surface.note(axes, text, "white")
    fig_surface.draw_scale(figure, image, bar_axes, label, "min" if levels else "neither")
    return figure


def figures(selection: load.Selection) -> list[Figure]:
    return [*intensity(selection), *sensation(selection)]


def sharpness(case: Case) -> str:
    share = number(case.value("sharpness_1", math.nan), 3)
    return f"sharpness {share}" if share else ""


def intensity(selection: load.Selection) -> list[Figure]:
    panels = shots_of(selection, load.mean_square, lambda squared: 1e6 * np.sqrt(squared))
    shots = [s for s in panels[0] if s]
    if not shots or all(wake.runs_straight_on(s.case) for s in shots) or not (end := max(s.u_um.max() for s in shots)) > 0:
        return []
    lines = [1e3 * line for s in shots if (mean := load.mean_square(s.case)) for line in mean[3]]
    limits = fig_surface.window(shots, end, np.concatenate(lines))
    figure = picture(selection, panels, limits, (0.0, end), "rms of $u_z$ over time (µm)", sharpness, interpolation="bicubic",
                     interpolation_stage="data")
    text = ("Root of the time-averaged intensity, the mean of u² over complete periods, of "
            f"{layout.plane_name([s.case for s in shots])}, on the same colour scale in all panels. Dashed lines or crosses: the shape that the focus draws.")
    if any(sharpness(s.case) and warnings_of.is_valid(s.case) for s in shots):
        text += " Sharpness: the fraction of this energy within one FWHM of the shape."
    return [Figure(figure, "intensity", "Time-averaged intensity", text,
                   "Time-averaged intensity seen from above", cases=[s.case.id for s in shots])]


RANGE_dB = 40.0  # of the colour scale, unless the threshold is farther below its end


def colour_limits(levels: list[np.ndarray]) -> tuple[float, float]:
    """What is felt is never black: the scale ends at the largest level and begins at 0 dB or below."""
    end = max(np.nanmax(level) for level in levels)
    return max(min(np.nanmin(level) for level in levels), min(0.0, end - RANGE_dB)), end


def felt_most(case: Case) -> str:
    peak, band = (number(case.value(column, math.nan), 3) for column in ("felt_peak_dB", "felt_band_Hz"))
    return f"{peak} dB at {band} Hz" if peak else ""


def sensation(selection: load.Selection) -> list[Figure]:
    """The level above the threshold of perception with the line where it is 0 dB."""
    panels = shots_of(selection, load.levels)
    shots = [s for s in panels[0] if s]
    finite = [s for s in shots if np.any(np.isfinite(s.u_um))]
    if not finite:
        return []
    edges = np.array([fig_surface.extent(s) for s in shots])
    limits = (edges[:, 0].min(), edges[:, 1].max(), edges[:, 2].min(), edges[:, 3].max())
    figure = picture(selection, panels, limits, colour_limits([s.u_um for s in finite]), "level above threshold (dB)", felt_most, levels=True)
    text = ("Level of the acceleration of the skin above the threshold of perception, the largest of all third octaves, in the "
            "measured region; grey is outside. Solid line: 0 dB, the limit of what can be felt. Dashed lines or crosses: the shape that the focus draws. "
            "Numbers: the largest level and the third octave that decides it.")
    return [Figure(figure, "sensation", "Level of sensation", text, "Level of sensation seen from above",
                   cases=[s.case.id for s in finite])]
