# SPDX-License-Identifier: BSD-3-Clause
"""Time-averaged intensity and level of sensation of the surface, with the shape that the focus draws."""
from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ... import wake
from .. import layout, load, style, warnings_of
from ..figure import Figure
from ..words import number
from . import fig_surface


def draw_lines(axes: Axes, lines: list[np.ndarray]) -> None:
    for line in lines:
        axes.plot(*(1e3 * line).T, color="white", linewidth=0.9, linestyle=(0, (3, 2)),
                  marker="+" if len(line) == 1 else "", path_effects=style.halo(1.8, "black"))


def window(found: list[Any], shots: list[fig_surface.Snapshot], end: float) -> tuple[float, float, float, float]:
    """The rectangle that contains all visible vibration and the drawn shape."""
    limits = fig_surface.window(shots, end)
    points = 1e3 * np.concatenate([line for _, (_, _, _, lines) in found for line in lines])
    low, high = points.min(axis=0) - 3.0, points.max(axis=0) + 3.0
    return (min(limits[0], low[0]), max(limits[1], high[0]), min(limits[2], low[1]),
            max(limits[3], high[1]))


def figures(selection: load.Selection) -> list[Figure]:
    return [*intensity(selection), *sensation(selection)]


def intensity(selection: load.Selection) -> list[Figure]:
    cells, columns = fig_surface.cells(selection)
    with_map = [(c, m) if c and (m := load.mean_square(c)) else None for c in cells]
    found = [f for f in with_map if f]
    if not found or all(wake.runs_straight_on(c) for c, _ in found):
        return []
    shots = [f and fig_surface.Snapshot(f[0], f[0].focus["time"][-1], 1e3 * f[1][0], 1e3 * f[1][1],
                                        1e6 * np.sqrt(f[1][2])) for f in with_map]
    end = max(s.u_um.max() for s in shots if s)
    if not end > 0:
        return []
    limits = window(found, [s for s in shots if s], end)
    figure, made, bar_axes = fig_surface.arrange(selection, shots, columns, limits)
    for axes, shot, cell in zip(made, shots, with_map):
        if not shot or not cell:
            continue
        image = axes.imshow(shot.u_um.T, origin="lower", cmap="magma", vmin=0.0, vmax=end,
                            extent=fig_surface.extent(shot), interpolation="bicubic",
                            interpolation_stage="data")
        draw_lines(axes, cell[1][3])
        fig_surface.frame(axes, limits)
        fig_surface.attach_values(axes, shot.x_mm, shot.y_mm, shot.u_um, limits, "rms of u")
        share = number(shot.case.value("sharpness_1", math.nan), 3)
        if share and warnings_of.is_valid(shot.case):
            fig_surface.note(axes, f"sharpness {share}", "white")
    bar = figure.colorbar(image, cax=bar_axes, orientation="horizontal",
                          label="rms of $u_z$ over time (µm)")
    bar.outline.set_linewidth(0.5)
    bar_axes.grid(False)
    text = ("Root of the time-averaged intensity, the mean of u² over complete periods, of "
            f"{layout.plane_name([c for c, _ in found])}, on the same colour scale in all panels. Dashed lines or crosses: the shape that the focus draws.")
    if any(s and number(s.case.value("sharpness_1", math.nan)) and warnings_of.is_valid(s.case) for s in shots):
        text += " Sharpness: the fraction of this energy within one FWHM of the shape."
    return [Figure(figure, "intensity", "Time-averaged intensity", text,
                   "Time-averaged intensity seen from above",
                   cases=[case.id for case, _ in found])]


RANGE_dB = 40.0  # of the colour scale, unless the threshold is farther below its end


def colour_limits(levels: list[np.ndarray]) -> tuple[float, float]:
    """What is felt is never black: the scale ends at the largest level and begins at 0 dB or below."""
    end = max(np.nanmax(level) for level in levels)
    return max(min(np.nanmin(level) for level in levels), min(0.0, end - RANGE_dB)), end


def sensation(selection: load.Selection) -> list[Figure]:
    """The level above the threshold of perception with the line where it is 0 dB."""
    cells, columns = fig_surface.cells(selection)
    found = [(c, m) if c and (m := load.levels(c)) else None for c in cells]
    shown = [f for f in found if f and np.any(np.isfinite(f[1][2]))]
    if not shown:
        return []
    shots = [f and fig_surface.Snapshot(f[0], f[0].focus["time"][-1], 1e3 * f[1][0], 1e3 * f[1][1], f[1][2]) for f in found]
    low, end = colour_limits([m[2] for _, m in shown])
    edges = np.array([fig_surface.extent(s) for s in shots if s])
    limits = (edges[:, 0].min(), edges[:, 1].max(), edges[:, 2].min(), edges[:, 3].max())
    figure, made, bar_axes = fig_surface.arrange(selection, shots, columns, limits)
    for axes, shot, cell in zip(made, shots, found):
        if not shot or not cell:
            continue
        image = axes.imshow(shot.u_um.T, origin="lower", cmap="magma", vmin=low, vmax=end, extent=fig_surface.extent(shot))
        axes.set_facecolor("0.4")  # outside the measured region
        fig_surface.draw_threshold(axes, cell[1], "white")
        mean = load.mean_square(shot.case)
        draw_lines(axes, mean[3] if mean else [])
        fig_surface.frame(axes, limits)
        fig_surface.attach_values(axes, shot.x_mm, shot.y_mm, shot.u_um, limits, "level", "dB")
        peak, band = number(shot.case.value("felt_peak_dB", math.nan), 3), number(shot.case.value("felt_band_Hz", math.nan), 3)
        if peak and warnings_of.is_valid(shot.case):
            fig_surface.note(axes, f"{peak} dB at {band} Hz", "white")
    bar = figure.colorbar(image, cax=bar_axes, orientation="horizontal", label="level above threshold (dB)", extend="min")
    bar.outline.set_linewidth(0.5)
    bar_axes.grid(False)
    text = ("Level of the acceleration of the skin above the threshold of perception, the largest of all third octaves, in the "
            "measured region; grey is outside. Solid line: 0 dB, the limit of what can be felt. Dashed lines or crosses: the shape that the focus draws. "
            "Numbers: the largest level and the third octave that decides it.")
    return [Figure(figure, "sensation", "Level of sensation", text, "Level of sensation seen from above",
                   cases=[case.id for case, _ in shown])]
