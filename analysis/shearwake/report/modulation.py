# SPDX-License-Identifier: BSD-3-Clause
"""Draws a modulation: its path with time ticks, and its speed and envelope over one period.

Usage: python3 -m shearwake.report.modulation DATA.json PICTURE    (`shearwake show --modulation JOB` writes the data)
The extension of PICTURE determines its format: .png, .svg or .pdf. Exit 0: done; 6: a file cannot be read or
written.
"""
from __future__ import annotations

import json
import sys
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from .. import figure_style
from .style import GREY, INK, PALETTE, halo, plt

ENVIRONMENT = 6
TICKS = 8
SLOW_PERIODS = 40
SMALL_DPI = 90  # for the small pictures of the documentation


def round_step(span: Any, count: Any) -> Any:
    """The smallest step of 1, 2 or 5 times a power of ten that divides the span into at most `count` parts."""
    least = span / count
    decade = 10.0 ** np.floor(np.log10(least))
    return next(f * decade for f in (1, 2, 5, 10) if f * decade >= least * (1 - 1e-9))


def draw_path(axes: Axes, data: Any) -> None:
    run = {key: np.array(values) for key, values in data["run"].items()}
    x, y, t = 1e3 * run["x_m"], 1e3 * run["y_m"], 1e3 * run["t_s"]
    foci = list(zip(data["foci_x_m"], data["foci_y_m"])) or [(0.0, 0.0)]
    for fx, fy in foci:
        axes.plot(x + 1e3 * fx, y + 1e3 * fy, color=PALETTE[0], linewidth=1.0)
    moves = np.ptp(x) + np.ptp(y) > 0
    ticks = np.arange(0.0, t[-1] * (1 + 1e-9), round_step(t[-1], TICKS)) if moves else np.zeros(1)
    places = [(float(np.interp(tick, t, x)), float(np.interp(tick, t, y))) for tick in ticks]
    for fx, fy in foci:
        axes.plot([px + 1e3 * fx for px, _ in places], [py + 1e3 * fy for _, py in places], "o",
                  color=INK, markersize=3.5)
    written: list[tuple[float, float]] = []  # positions of labels; ticks too close to one of them get no label
    reach = max(np.ptp(x), np.ptp(y), 1.0)
    for tick, place in zip(ticks, places):
        if moves and all(np.hypot(place[0] - a, place[1] - b) > 0.09 * reach for a, b in written):
            axes.annotate(f"{tick:g}", place, textcoords="offset points", xytext=(3, 4), fontsize=8,
                          color=INK, path_effects=halo())
            written.append(place)
    if not moves:
        axes.set_xlim(min(p for p, _ in places) - 5 + 1e3 * min(f for f, _ in foci),
                      max(p for p, _ in places) + 5 + 1e3 * max(f for f, _ in foci))
    margin = 0.15 * reach
    low, high = axes.get_ylim()
    axes.set_ylim(min(low, float(np.min(y)) - margin), max(high, float(np.max(y)) + margin))
    axes.set_aspect("equal", adjustable="datalim")
    axes.set_xlabel("x (mm)")
    axes.set_ylabel("y (mm)")
    axes.set_title(data["kind"] + (": path, ticks in ms" if moves else ": focus at rest"), loc="left")


def draw_curve(axes: Axes, t_s: Any, values: Any, label: str, colour: Any) -> None:
    t = 1e3 * np.array(t_s)
    axes.plot(t, values, color=colour)
    axes.fill_between(t, values, color=colour, alpha=0.12, linewidth=0)
    axes.set_ylim(0.0, 1.15 * (np.max(values) or 1.0))
    axes.set_xlim(0.0, t[-1])
    axes.set_ylabel(label)


def draw_courses(speed_axes: Any, gain_axes: Any, data: Any) -> None:
    period, run, frequency = data["period"], data["run"], data["frequency_Hz"]
    # A slow focus hardly moves within a period, so its speed is drawn over the run.
    is_slow = run["t_s"][-1] > SLOW_PERIODS * period["t_s"][-1]
    shown = run if is_slow else period
    draw_curve(speed_axes, shown["t_s"], shown["speed_m_s"], "speed (m/s)", PALETTE[2])
    draw_curve(gain_axes, period["t_s"], period["gain"], "envelope", PALETTE[1])
    if is_slow:
        speed_axes.set_xlabel("t (ms), the run")
    else:
        speed_axes.tick_params(labelbottom=False)
    gain_axes.set_xlabel("t (ms)" + (f", one period of {frequency:g} Hz" if frequency else ""))
    gain_axes.axhline(1.0, color=GREY, linewidth=0.6, linestyle=":")


def draw(data: Any, picture: Any) -> None:
    figure = plt.figure(figsize=(6.6, 2.5), layout="constrained")
    grid = figure.add_gridspec(2, 2, width_ratios=(1.25, 1.0))
    draw_path(figure.add_subplot(grid[:, 0]), data)
    draw_courses(figure.add_subplot(grid[0, 1]), figure.add_subplot(grid[1, 1]), data)
    figure.savefig(picture, dpi=SMALL_DPI, facecolor="white")
    plt.close(figure)


def main(arguments: Any) -> Any:
    if len(arguments) != 2:
        print("usage: python3 -m shearwake.report.modulation DATA.json PICTURE", file=sys.stderr)
        return 2
    try:
        with open(arguments[0], encoding="utf-8") as file:
            data = json.load(file)
        figure_style.reset()
        draw(data, arguments[1])
    except (OSError, ValueError) as error:
        print(f"modulation: {error}", file=sys.stderr)
        return ENVIRONMENT
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
