# SPDX-License-Identifier: BSD-3-Clause
"""Arranges pairs of slices such that a millimetre has the same length along both axes and in all panels."""
from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
from matplotlib.axes import Axes

from .. import layout, style

LOW_in, HIGH_in = 0.55, 3.4  # of panels: lower ones are placed below each other, higher ones are reduced
LEFT_in, RIGHT_in, BETWEEN_in, BELOW_in, BAR_in = 0.66, 0.2, 0.72, 0.46, 0.62
LINE_in = 0.165


def scale_of(rows: list[tuple[str, list[Any]]]) -> tuple[float, bool]:
    """Inches per mm, and whether the slices of a pair are next to each other."""
    pairs = [pair for _, pair in rows]
    highest = max(height for pair in pairs for _, _, height in pair)
    beside = (style.width_in() - LEFT_in - RIGHT_in - BETWEEN_in) / max(sum(width for _, width, _ in pair) for pair in pairs)
    if beside * min(height for pair in pairs for _, _, height in pair) >= LOW_in:
        return min(beside, HIGH_in / highest), True
    below = (style.width_in() - LEFT_in - RIGHT_in) / max(width for pair in pairs for _, width, _ in pair)
    return min(below, HIGH_in / highest), False


def lines_of(rows: list[tuple[str, list[Any]]], scale: float, beside: bool) -> list[list[tuple[float, float, float, str]]]:
    """The lines of panels from top to bottom: lists of (left edge, width and height in inches, title)."""
    lines = []
    for label, pair in rows:
        panels, left = [], LEFT_in
        for n, (name, width, height) in enumerate(pair):
            full = f"{label}, {name}" if label and n == 0 else name
            room = width * scale if beside and n == 0 else style.width_in() - left
            panels.append((left, width * scale, height * scale, layout.wrapped(full, max(2.2, room))))
            left += (width * scale + BETWEEN_in) if beside else 0.0
        lines += [panels] if beside else [[panel] for panel in panels]
    return lines


def arrange(rows: list[tuple[str, list[Any]]]) -> tuple[Any, list[tuple[Axes, Axes]], Axes]:
    """Axes of equal scale for pairs of slices, and the axes of a common colour bar. Rows: (label, two slices as (title,
    width in mm, height in mm)). Returns the figure, a pair of axes per row, and the axes of the bar."""
    scale, beside = scale_of(rows)
    lines = lines_of(rows, scale, beside)
    above = [0.12 + LINE_in * max(title.count("\n") + 1 for *_, title in line) for line in lines]
    total = sum(above) + sum(max(height for _, _, height, _ in line) + BELOW_in for line in lines) + BAR_in
    figure = plt.figure(figsize=(style.width_in(), total))
    made, top = [], total
    for line, title_in in zip(lines, above):
        top -= title_in
        for left, width, height, title in line:
            axes = figure.add_axes([left / style.width_in(), (top - height) / total, width / style.width_in(), height / total])
            axes.set_title(title, loc="left", fontsize=9, pad=5)
            axes.grid(False)
            made.append(axes)
        top -= max(height for _, _, height, _ in line) + BELOW_in
    bar = figure.add_axes([0.22, 0.46 / total, 0.56, 0.12 / total])
    return figure, list(zip(made[::2], made[1::2])), bar
