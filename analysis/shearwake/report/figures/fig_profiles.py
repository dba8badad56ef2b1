# SPDX-License-Identifier: BSD-3-Clause
"""Profiles of the displacement through the focus, along and across its path."""
from __future__ import annotations

import math
from typing import Any

import numpy as np

from ... import wake
from ...case import Case
from .. import layout, load, warnings_of
from ..figure import Figure
from ..page.chart import Chart, Line
from ..words import number, strongest_text
from . import fig_surface, fig_time
from .chart_figure import chart_figure


def sample(shot: fig_surface.Snapshot, x_mm: np.ndarray, y_mm: np.ndarray) -> np.ndarray:
    """u in um at points, bilinear between the points of the grid; NaN outside."""
    inside = [(points > nodes[0] - 1e-9) & (points < nodes[-1] + 1e-9)
              for points, nodes in ((np.asarray(x_mm), shot.x_mm), (np.asarray(y_mm), shot.y_mm))]
    return np.where(inside[0] & inside[1], load.bilinear(shot.x_mm, shot.y_mm, shot.u_um, x_mm, y_mm), math.nan)


def last_shot(case: Case) -> fig_surface.Snapshot | None:
    """The last snapshot while the load acts; the last one if there is none."""
    times = load.surface_times(case)
    if not len(times):
        return None
    acting = [n for n, t in enumerate(times) if not wake.is_over(case, t)]
    shot = fig_surface.shot_of(case, acting[-1] if acting else -1)
    return shot if np.isfinite(shot.u_um).any() and min(shot.u_um.shape) > 1 else None


def focus_mm(shot: fig_surface.Snapshot) -> np.ndarray:
    return wake.strongest_focus_mm(shot.case, shot.t_s, lambda x, y: sample(shot, x, y))


def profile(shot: fig_surface.Snapshot, along: bool) -> tuple[np.ndarray, np.ndarray]:
    """Distances from the focus in mm and u in um on a line through the focus. A focus at rest has no direction of
    motion: its lines are parallel to x and y."""
    focus, direction = focus_mm(shot), wake.focus_at(shot.case, shot.t_s)[1]
    unit = np.array([1.0, 0.0]) if direction is None else np.asarray(direction)
    if not along:
        unit = np.array([-unit[1], unit[0]])
    step = min(shot.x_mm[1] - shot.x_mm[0], shot.y_mm[1] - shot.y_mm[0])
    reach = math.hypot(shot.x_mm[-1] - shot.x_mm[0], shot.y_mm[-1] - shot.y_mm[0])
    distance = step * np.arange(-math.ceil(reach / step), math.ceil(reach / step) + 1)
    u = sample(shot, focus[0] + distance * unit[0], focus[1] + distance * unit[1])
    return distance[np.isfinite(u)], u[np.isfinite(u)]


def charts_of(shots: list[fig_surface.Snapshot], colours: dict[str, Any], labels: list[str], titles: tuple[str, str]) -> list[Chart]:
    return [Chart("distance from the focus (mm)", "$u_z$ (µm)", [
        Line(label, *profile(shot, along), colours[shot.case.id], shot.case.id, dashed=shot.case.is_reference)
        for shot, label in zip(shots, labels)], title) for along, title in zip((True, False), titles)]


def figures(selection: load.Selection) -> list[Figure]:
    some = layout.lines_of_one_panel(selection)
    cases = layout.with_references(some)
    shots = [shot for case in cases if (shot := last_shot(case))]
    if not shots:
        return []
    drawn = [s.case for s in shots]
    colours = fig_time.colours_in_one_panel(some, drawn)
    moves = [wake.focus_at(s.case, s.t_s)[1] is not None for s in shots]
    titles = (("along the path, ahead of the focus at the right", "across the path") if all(moves) else
              ("along x", "along y") if not any(moves) else
              ("along the path, or along x if the focus rests", "across the path, or along y if the focus rests"))
    labels = [warnings_of.label(some, c, "profiles") for c in drawn]
    charts = charts_of(shots, colours, labels, titles)
    times = sorted({number(1e3 * s.t_s) for s in shots}, key=float)
    text = (f"Displacement of {layout.plane_name(drawn)} on two lines through the focus at t = {times[0]}"
            f"{f' to {times[-1]}' if len(times) > 1 else ''} ms, the last snapshot while the load acts."
            + strongest_text(focus_mm(s) for s in shots if len(wake.offsets_mm(s.case)) > 1))
    if any(c.is_reference for c in drawn):
        text += f" Dashed: {layout.reference_name(layout.all_references(some))}."
    title = "Profiles through the focus"
    return [Figure(chart_figure(charts, sharex=False), "profiles", title, text, title + ", one line per case", charts, cases=[c.id for c in drawn])]
