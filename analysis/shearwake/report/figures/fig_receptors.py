# SPDX-License-Identifier: BSD-3-Clause
"""A map of the receptors on the hand with the pins and the path of the focus."""
from __future__ import annotations


import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ... import wake
from .. import layout, style
from ..figure import Figure
from ..load import Selection
from ..words import OTHERS, counted
from . import fig_hand

MARGIN_mm = 15.0  # around the receptors, pins and the path


def to_hand(afferents: fig_hand.Afferents, points_mm: np.ndarray) -> np.ndarray:
    """Points of the skin patch in coordinates of the hand. The patch is a rotated and shifted part of the hand; its
    receptors, of which both places are known, determine how."""
    patch = afferents.patch @ np.array([1.0, 1.0j])
    hand = afferents.x + 1j * afferents.y
    apart = patch - patch.mean()
    size = float(np.sum(np.abs(apart)**2))
    turn = np.sum(np.conj(apart) * (hand - hand.mean())) / size if size > 1e-6 else 1.0
    placed = hand.mean() + turn * (points_mm @ np.array([1.0, 1.0j]) - patch.mean())
    return np.column_stack([placed.real, placed.imag])


def frame(axes: Axes, afferents: fig_hand.Afferents, path: np.ndarray) -> None:
    """Shows the part of the hand with all receptors, pins and the path."""
    points = np.concatenate([np.column_stack([afferents.x, afferents.y]), afferents.pins, path])
    low, high = points.min(axis=0) - MARGIN_mm, points.max(axis=0) + MARGIN_mm
    axes.set_xlim(low[1], high[1])
    axes.set_ylim(-high[0], -low[0])
    axes.set_axis_on()
    axes.set_xticks([])
    axes.set_yticks([])


def scale_bar(axes: Axes) -> None:
    """A bar of 1, 2, 5, 10, 20 or 50 mm, at most 0.3 of the width, in the lower left corner."""
    (left, right), (low, high) = axes.get_xlim(), axes.get_ylim()
    length = max(mm for mm in (1, 2, 5, 10, 20, 50) if mm <= 0.3 * (right - left))
    x, y = left + 0.05 * (right - left), low + 0.05 * (high - low)
    axes.plot([x, x + length], [y, y], color=style.INK, linewidth=2.0, solid_capstyle="butt", zorder=6)
    axes.text(x + length / 2, y + 0.015 * (high - low), f"{length} mm", ha="center", va="bottom", fontsize=9, zorder=6)


def figures(selection: Selection) -> list[Figure]:
    cases = [c for c in layout.ordinary(selection) if "afferents" in c.parameters]
    if not cases:
        return []
    case = cases[0]
    afferents = fig_hand.Afferents(case)
    kinds = afferents.present()
    if not kinds:
        return []
    path = to_hand(afferents, wake.focus_at(case, case.over_time["time"][-1])[2])
    figure, made = plt.subplots(1, len(kinds), squeeze=False, layout="constrained",
                                figsize=(style.width_in(), 4.6 if len(kinds) < 3 else 3.6))
    for axes, kind in zip(made[0], kinds):
        fig_hand.hand_axes(axes, afferents)
        every = afferents.of(kind)
        few = len(every) < 300
        axes.scatter(afferents.y[every], -afferents.x[every], s=26 if few else 2, zorder=5 if few else 2,
                     color=afferents.colours[kind], linewidths=0.6 if few else 0.0, edgecolors="white")
        axes.plot(path[:, 1], -path[:, 0], color="#111111", linewidth=1.4, zorder=3,
                  marker="o" if np.ptp(path, axis=0).max() < 1e-6 else "", markersize=5)
        if not fig_hand.feels_stress(case):
            axes.plot(afferents.pins[:, 1], -afferents.pins[:, 0], "+", color="#cc0000", markersize=13,
                      markeredgewidth=1.4, zorder=4)
        frame(axes, afferents, path)
        scale_bar(axes)
        axes.set_title(f"{kind}: {counted(len(every), 'receptor')}", pad=3)
    text = "Dots: receptors of each class on the palmar side of a right hand."
    text += "" if fig_hand.feels_stress(case) else " Red crosses: pins that move the skin."
    text += " Black: path of the focus." if np.ptp(path, axis=0).max() > 1e-6 else " Black dot: the focus, which rests."
    places = {(round(x, 6), round(y, 6)) for x, y in zip(afferents.x, afferents.y)}
    if len(places) < len(afferents.x):
        text += f" The {counted(len(afferents.x), 'receptor')} are at {counted(len(places), 'place')}."
    if len(cases) > 1:
        text += f" The figure shows the first case, {layout.case_label(selection, case)}; {OTHERS}."
    title = "Receptors and path" if fig_hand.feels_stress(case) else "Receptors, pins and path"
    return [Figure(figure, "receptors", title, text, title + " on the hand", cases=[case.id])]
