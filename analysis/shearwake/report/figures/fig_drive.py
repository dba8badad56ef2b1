# SPDX-License-Identifier: BSD-3-Clause
"""Position and force of the focus over time for a few cases."""
from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ... import wake
from ...case import Case
from .. import layout, references, style
from ..figure import Figure
from ..load import Selection
from ..words import number

CASES = 4
LEAD = 1e-3  # of the length of the path: smaller leads over the reference are neglected


def chosen(selection: Selection) -> list[Case]:
    """The reference, then cases from the first to the last curve; if x is a string, all cases of the first
    curve."""
    found = layout.groups(selection)
    if found and not layout.is_numeric(selection) and len(found[0].cases) <= CASES:
        picks = found[0].cases
    else:
        each = CASES - 1 if len(found) == 1 else 2
        picks = [c for g in layout.evenly(found, 2) for c in layout.evenly(g.cases, each)]
    return [c for c in references.with_references(selection, picks, CASES) if "force" in c.over_time]


def lead_mm(selection: Selection, case: Case) -> np.ndarray | None:
    """Lead of the focus over that of its reference along the path of the reference, over time; None if both
    have the same path or there is no reference."""
    reference = selection.reference_of(case)
    if not reference or len(reference.over_time["time"]) != len(case.over_time["time"]):
        return None
    own, other = (1e3 * np.column_stack([c.over_time["focus_x"], c.over_time["focus_y"]])
                  for c in (case, reference))
    direction = other[-1] - other[0]
    length = float(np.hypot(*direction))
    if not length > 0 or np.abs(own - other).max() < LEAD * length:
        return None
    return (own - other) @ direction / length


def draw_place(axes: Axes, case: Case) -> None:
    """Draws the coordinates that change while the load acts; a line along x has one curve."""
    pressed = wake.last_pressed(case) + 1
    time = 1e3 * case.over_time["time"][:pressed]
    for name, look in (("x", {"color": style.PALETTE[0]}),
                       ("y", {"color": style.PALETTE[1], "linestyle": "--"})):
        place = 1e3 * case.over_time["focus_" + name][:pressed]
        if np.ptp(place) > 0:
            axes.plot(time, place, linewidth=1.3, label=name, **look)


def draw_lead(axes: Axes, selection: Selection, case: Case) -> None:
    lead = lead_mm(selection, case)
    time = 1e3 * case.over_time["time"]
    axes.plot(time, np.zeros(len(time)) if lead is None else lead, color=style.PALETTE[2],
              linewidth=1.3)


def draw_force(axes: Axes, case: Case) -> None:
    axes.plot(1e3 * case.over_time["time"], 1e3 * case.over_time["force"], color=style.INK,
              linewidth=1.2)


def changes(case: Case) -> bool:
    """Whether the force changes while the load acts."""
    force = case.over_time["force"][: wake.last_pressed(case) + 1]
    return np.ptp(force) > 1e-6 * np.abs(force).max()


def figures(selection: Selection) -> list[Figure]:
    cases = chosen(selection)
    if not cases:
        return []
    name = layout.reference_name(layout.all_references(selection))
    columns = []
    if any(np.ptp(c.over_time[name]) > 0 for c in cases for name in ("focus_x", "focus_y")):
        columns.append(("place", draw_place))
    if any(lead_mm(selection, c) is not None for c in cases):
        columns.append((f"ahead of\n{name} (mm)", lambda axes, c: draw_lead(axes, selection, c)))
    steady = not any(map(changes, cases))
    if not steady or not columns:
        columns.append(("force (mN)", draw_force))
    title, ids = "How the skin is driven", [case.id for case in cases]
    return [Figure(picture(selection, cases, columns), "drive", title, caption(cases, columns, steady, name),
                   "Position and force over time", cases=ids)]


def picture(selection: Selection, cases: list[Case], columns: list[tuple[str, Any]]) -> Any:
    """One row per case."""
    figure, made = style.panels(len(cases) * len(columns), len(columns), 1.25, 0.9, sharex=True, sharey="col")
    for row, case in zip(made, cases):
        for axes, (_, draw) in zip(row, columns):
            draw(axes, case)
        row[0].set_title(layout.case_label(selection, case), loc="left", fontsize=9)
    for axes, (label, _) in zip(made[len(cases) // 2], columns):
        axes.set_ylabel(label)
    if columns[-1][1] is draw_force:
        largest = max(1e3 * c.over_time["force"].max() for c in cases)
        made[0, -1].set_ylim(-0.04 * largest, 1.08 * largest)
    figure.supxlabel("time (ms)", fontsize=9.5)
    if columns[0][1] is draw_place:
        name_places(made, len(cases) // 2)
    return figure


def name_places(made: np.ndarray, middle: int) -> None:
    lines = {line.get_label(): line for axes in made[:, 0] for line in axes.get_lines()}
    label = "position" if len(lines) > 1 else next(iter(lines))
    made[middle, 0].set_ylabel(f"{label} (mm)")
    if len(lines) > 1:
        style.legend_strip(made[0, 0].figure, list(lines.values()))


def caption(cases: list[Case], columns: list[tuple[str, Any]], steady: bool, name: str) -> str:
    parts = []
    for _, draw in columns:
        if draw is draw_place:
            parts.append("position of the focus (x and y if they change)")
        elif draw is draw_force:
            parts.append("force of the complete footprint, averaged over a cycle of the carrier")
        else:
            parts.append(f"distance of the focus ahead of {name}")
    text = "; ".join(parts) + "."
    text = text[:1].upper() + text[1:]
    if steady and columns[-1][1] is not draw_force:
        forces = sorted({float(f"{1e3 * c.over_time['force'].max():.3g}") for c in cases})
        text += (f" The force is constant, {number(forces[0], 3)}"
                 + (f" to {number(forces[-1], 3)}" if len(forces) > 1 else "") + " mN.")
    return text
