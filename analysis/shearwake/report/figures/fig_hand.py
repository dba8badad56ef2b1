# SPDX-License-Identifier: BSD-3-Clause
"""Firing afferents on the hand, their spikes over time, and the motion of the skin."""
from __future__ import annotations

import math
from dataclasses import replace

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ...case import Case
from .. import layout, style, warnings_of
from ..figure import Figure
from ..load import Selection
from ..words import counted, millimetres, number

MOST_CASES = 6  # largest number of cases with figures
PLACES = 5  # largest number of places at which motion and spikes are drawn
NEAR_mm = 4.0  # largest distance of afferents from their place
MOST_TICKS = 200  # largest number of afferents per class in a raster


class Afferents:
    """The afferents of a case file, in mm and ms, with one array of spikes per afferent."""

    def __init__(self, case: Case) -> None:
        found, pins, hand = (case.arrays(name) for name in ("afferents", "pins", "hand"))
        self.x, self.y = 1e3 * found["hand_x"], 1e3 * found["hand_y"]
        self.patch = 1e3 * np.stack([found["x"], found["y"]], axis=1)
        self.kind, self.number = case.receptor_classes(), found["class"].astype(int)
        self.colours = case.receptor_colours()
        self.count = found["spike_count"].astype(int)
        self.outline = 1e3 * np.stack([hand["hand_x"], hand["hand_y"]], axis=1)
        self.pins = 1e3 * np.stack([pins["hand_x"], pins["hand_y"]], axis=1)
        self.pins_on_patch = 1e3 * np.stack([pins["x"], pins["y"]], axis=1)
        self.u_um = 1e6 * pins["u_z"] if "u_z" in pins else None
        self.time = 1e3 * pins["time"] if "time" in pins else None
        self.spikes = np.split(1e3 * found["spike_time"], np.cumsum(self.count)[:-1]) if len(self.count) else []

    def of(self, kind: str) -> np.ndarray:
        return np.flatnonzero(self.kind == kind)

    def present(self) -> list[str]:
        """The classes with an afferent, in the order of their numbers."""
        return list(dict.fromkeys(self.kind[np.argsort(self.number, kind="stable")].tolist()))


def feels_stress(case: Case) -> bool:
    """Whether the stress at the receptors is the input. Pins then exert no motion and only mark places."""
    return case.setting("afferents", "input", default="") == "stress"


def hand_axes(axes: Axes, afferents: Afferents) -> None:
    """Draws the palmar side of a right hand with the fingers up and the thumb to the left."""
    outline = np.vstack([afferents.outline, afferents.outline[:1]])
    axes.fill(outline[:, 1], -outline[:, 0], color="#f7f3ef", zorder=0)
    axes.plot(outline[:, 1], -outline[:, 0], color="#999999", linewidth=0.9, zorder=1)
    axes.set_aspect("equal")
    axes.axis("off")


def rates_Hz(case: Case, afferents: Afferents) -> np.ndarray:
    return afferents.count / case.counted_s


def hand_figure(selection: Selection, case: Case, afferents: Afferents, name: str, highest: float) -> Figure:
    """One hand per class with a dot per firing afferent, coloured by its rate, up to the `highest` of all hands in Hz."""
    kinds = afferents.present()
    rates = rates_Hz(case, afferents)
    figure, made = plt.subplots(1, len(kinds), squeeze=False, layout="constrained",
                                figsize=(style.width_in(), 4.3 if len(kinds) < 3 else 3.5))
    for axes, kind in zip(made[0], kinds):
        hand_axes(axes, afferents)
        all_of, fires = afferents.of(kind), afferents.count > 0
        silent, active = all_of[~fires[all_of]], all_of[fires[all_of]]
        axes.scatter(afferents.y[silent], -afferents.x[silent], s=0.6, color="#c4c4c4", zorder=2)
        active = active[np.argsort(rates[active])]
        shown = axes.scatter(afferents.y[active], -afferents.x[active], s=7, c=rates[active],
                             cmap=style.sequential_map(), vmin=0.0, vmax=highest, zorder=3,
                             linewidths=0)
        if not feels_stress(case):  # drawn below the dots, so that their colours are visible
            axes.plot(afferents.pins[:, 1], -afferents.pins[:, 0], "+", color="#cc0000",
                      markersize=5 if len(afferents.pins) > 1 else 7, markeredgewidth=0.8,
                      zorder=2.5)
        axes.set_title(f"{kind}: {len(active)} of {len(all_of)} {'fires' if len(active) == 1 else 'fire'}", pad=3)
    style.bar_beside(figure, shown, made[0].tolist(), "firing rate (Hz)", aspect=28, shrink=0.8)
    title = f"Firing afferents on the hand: {warnings_of.label(selection, case, name)}"
    return Figure(figure, name, title, "Coloured dots: firing afferents with their mean rate, on the same colour scale for all cases. Grey dots: "
                  "silent afferents." + ("" if feels_stress(case) else
                  " Red crosses: pins that move the skin."), title)


def raster_rows(afferents: Afferents, kind: str) -> list[int]:
    """The firing afferents, sorted by their distance from the nearest pin, nearest first."""
    rows = afferents.of(kind)
    rows = rows[afferents.count[rows] > 0]
    between = np.hypot(afferents.x[rows, None] - afferents.pins[None, :, 0],
                       afferents.y[rows, None] - afferents.pins[None, :, 1])
    return layout.evenly(rows[np.argsort(between.min(axis=1), kind="stable")].tolist(), MOST_TICKS)


def raster_figure(selection: Selection, case: Case, afferents: Afferents, name: str) -> Figure | None:
    """Spikes over time; for a long run with an additional panel of its start, which shows bursts."""
    kinds = [k for k in afferents.present() if len(raster_rows(afferents, k))]
    if not kinds:
        return None
    counted_ms = 1e3 * case.counted_s
    spans = [40.0, counted_ms] if counted_ms > 200.0 else [counted_ms]
    figure, made = plt.subplots(len(kinds), len(spans), squeeze=False, layout="constrained",
                                figsize=(style.width_in(), 0.7 + 2.1 * len(kinds)))
    for line, kind in zip(made, kinds):
        rows = raster_rows(afferents, kind)
        for axes, span in zip(line, spans):
            axes.eventplot([afferents.spikes[i] for i in rows], color=afferents.colours[kind],
                           linelengths=max(0.9, len(rows) / 60.0),
                           linewidths=0.9 if span < 200.0 else 0.35)
            axes.set_xlim(0.0, span)
            axes.set_ylim(-0.5, max(len(rows), 5) - 0.5)
        line[0].set_ylabel(f"{kind}, near to distant")
        line[0].set_title(counted(int(afferents.count[afferents.of(kind)].sum()), "spike"), loc="left", pad=3)
    for axes in made[-1]:
        axes.set_xlabel("time (ms)")
    title = f"Spikes over time: {warnings_of.label(selection, case, name)}"
    return Figure(figure, name, title, f"One line per firing afferent (at most {MOST_TICKS} per class, chosen evenly), "
                  "sorted by its distance from the nearest "
                  + ("point of afferents.pins_mm." if feels_stress(case) else "pin.") +
                  (" Left: the first 40 ms." if len(spans) > 1 else ""), title)


def tick_at(top: float) -> float:
    """The largest number of the form 1 or 5 times a power of ten that is at most `top`."""
    power = 10.0 ** math.floor(math.log10(top))
    return 5.0 * power if 5.0 * power <= top else power


def places_figure(selection: Selection, case: Case, afferents: Afferents, name: str) -> Figure | None:
    """The motion of a few pins and, below each curve, the spikes of nearby afferents."""
    if afferents.u_um is None:
        return None
    pins = layout.evenly(range(len(afferents.pins)), PLACES)
    figure, made = plt.subplots(len(pins), 1, sharex=True, sharey=True, squeeze=False,
                                layout="constrained",
                                figsize=(style.width_in(), max(2.6, 0.7 + 1.25 * len(pins))))  # room for the vertical label
    used = set()
    for axes, pin in zip(made[:, 0], pins):
        near = np.hypot(*(afferents.patch - afferents.pins_on_patch[pin]).T) < NEAR_mm
        top = 1.1 * max(np.abs(afferents.u_um).max(), 1e-9)
        level, step = -1.25 * top, 0.16 * top
        for kind in afferents.present():
            for i in np.flatnonzero(near & (afferents.kind == kind) & (afferents.count > 0))[:9]:
                axes.plot(afferents.spikes[i], np.full(afferents.count[i], level), "|",
                          color=afferents.colours[kind], markersize=4.5, markeredgewidth=0.9)
                level -= step
                used.add(kind)
        axes.plot(afferents.time, afferents.u_um[pin], color=style.INK, linewidth=1.1)
        x, y = afferents.pins_on_patch[pin]
        axes.set_title(f"({millimetres(x)}, {millimetres(y)}) mm", loc="left", pad=2, fontsize=9)
        axes.set_yticks([0.0, tick_at(top)])
    made[-1, 0].set_xlabel("time (ms)")
    made[-1, 0].set_xlim(0.0, min(1e3 * case.counted_s, 200.0))
    figure.supylabel("indentation (µm); spikes below", fontsize=9.5)
    if used:
        made[0, 0].legend(handles=[plt.Line2D([], [], marker="|", linestyle="none", label=kind,
                                              color=afferents.colours[kind]) for kind in afferents.present()
                                   if kind in used], loc="lower right",
                          bbox_to_anchor=(1.0, 1.0), ncol=3, borderaxespad=0.1, handletextpad=0.2)
    title = f"Motion and spikes at selected pins: {warnings_of.label(selection, case, name)}"
    return Figure(figure, name, title, "Black: displacement of the pin, positive into the skin. Ticks: spikes of "
                  f"afferents within {number(NEAR_mm)} mm of the pin, one row per afferent, at most nine per "
                  "class.", title)


def figures(selection: Selection) -> list[Figure]:
    made = []
    cases = [c for c in layout.ordinary(selection) if c.is_complete and "afferents" in c.parameters]
    shown = [(n, c, a) for n, c in enumerate(layout.evenly(cases, MOST_CASES), start=1)
             if len((a := Afferents(c)).count) and not math.isnan(c.counted_s)]
    highest = max((rates_Hz(c, a).max() for _, c, a in shown), default=0.0) or 1.0
    for n, case, afferents in shown:
        for figure in (hand_figure(selection, case, afferents, f"hand_{n}", highest),
                       raster_figure(selection, case, afferents, f"raster_{n}"),
                       places_figure(selection, case, afferents, f"places_{n}")):
            if figure:
                made.append(replace(figure, cases=[case.id]))
    return made
