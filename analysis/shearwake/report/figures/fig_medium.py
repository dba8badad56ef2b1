# SPDX-License-Identifier: BSD-3-Clause
"""Vertical slices of the medium: its layers, bodies or map, with the path of the focus."""
from __future__ import annotations

import contextlib
import json
import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ... import wake
from ...case import Case
from ...inputs import MaterialMap, read_map
from .. import layout, medium_files, style
from ..figure import Figure
from ..load import Selection
from ..page import hover
from ..words import OTHERS, number
from . import to_scale

CASES = 4
ORANGE = "#D55E00"
RIGID = style.GREY  # the colour of rigid bodies without a shear-wave speed
POINTS = 240         # of a slice along its longer side
HALF_SPACE_mm = 20.0  # depth drawn of a half-space without deeper bodies
CLOSE = 0.08         # least distance between ticks of the colour bar, relative to its length
UNLIKE = 4.0         # largest ratio of shear-wave speeds on a linear colour scale


def axes_of(body: Any) -> Any:
    """The rows are the unit vectors of the body's own axes; the first one is the axis of a cylinder."""
    if body.get("axis") == "vertical":
        return np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
    turn, tilt, roll = (math.radians(body.get(f"{name}_deg", 0.0)) for name in ("azimuth", "inclination", "roll"))
    along = [math.cos(turn) * math.cos(tilt), math.sin(turn) * math.cos(tilt), math.sin(tilt)]
    across = np.array([-math.sin(turn), math.cos(turn), 0.0])
    down = np.array([-math.cos(turn) * math.sin(tilt), -math.sin(turn) * math.sin(tilt), math.cos(tilt)])
    return np.array([along, math.cos(roll) * across + math.sin(roll) * down,
                     math.cos(roll) * down - math.sin(roll) * across])


def has_ends(body: Any) -> bool:
    return 0.0 < body.get("length_m", 0.0) < math.inf


def is_inside(body: Any, x: Any, y: Any, z: Any) -> bool:
    """Whether points in m are within the body; its smooth edge counts up to its middle."""
    cx, cy, cz = body["centre_m"]
    u, v, w = (a * (x - cx) + b * (y - cy) + c * (z - cz) for a, b, c in axes_of(body))
    if body["shape"] == "ellipsoid":
        a, b, c = body["semi_axes_m"]
        return (u / a)**2 + (v / b)**2 + (w / c)**2 <= 1.0
    if body["shape"] == "box":
        a, b, c = body["size_m"]
        return (abs(u) <= a / 2) & (abs(v) <= b / 2) & (abs(w) <= c / 2)
    within = abs(u) <= body["length_m"] / 2 if has_ends(body) else np.ones_like(u, dtype=bool)
    return (v**2 + w**2 <= body["radius_m"]**2) & within


def is_grey(body: Any) -> bool:
    """Whether a body is rigid and has no shear-wave speed."""
    return body.get("rigid", False) and "c_s_m_s" not in body


def speed(medium: dict[str, Any], x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
    """The shear-wave speed in m/s at points in m; nan within a rigid body that has none. A later body covers an earlier
    one."""
    c_s, top = np.full(np.broadcast(x, y, z).shape, math.nan), 0.0
    layers = medium["layer"]
    for n, layer in enumerate(layers):
        endless = n == len(layers) - 1 and medium.get("base") == "half-space"
        below = math.inf if endless else top + layer["thickness_m"]
        c_s[np.broadcast_to((z >= top) & (z <= below), c_s.shape)] = layer["c_s_m_s"]
        top = below
    for body in medium.get("body", []):
        if "c_s_m_s" in body or is_grey(body):  # otherwise that of the layer
            c_s[is_inside(body, *np.broadcast_arrays(x, y, z))] = body.get("c_s_m_s", math.nan)
    return c_s


def depth_mm(medium: dict[str, Any]) -> float:
    """The depth that is drawn: down to the base, or below the deepest interface of a half-space."""
    total = 1e3 * sum(layer.get("thickness_m", 0.0) for layer in medium["layer"])
    if medium.get("base") != "half-space":
        return total
    deepest = max((1e3 * body["centre_m"][2] for body in medium.get("body", [])), default=0.0)
    return max(HALF_SPACE_mm, 1.3 * total, 1.5 * deepest)


@dataclass
class Slice:
    name: str            # 'y = 0 mm'
    label: str           # of the horizontal axis
    extent: tuple        # in mm: left, right, bottom, top
    c_s: np.ndarray      # (z, horizontal)
    marks: np.ndarray    # (n, 2), the path of the focus in mm: horizontal, depth


def slices(x_mm: Any, y_mm: Any, below_mm: float, centre_mm: np.ndarray, speed_at: Callable[..., Any],
           marks: np.ndarray) -> list[Slice]:
    """The planes y = centre and x = centre. x_mm and y_mm are the ends of the axes."""
    z = np.linspace(0.0, below_mm, POINTS)[:, None]
    made = []
    for axis, (low, high) in enumerate((x_mm, y_mm)):
        at = centre_mm[1 - axis]
        row, number_m = 1e-3 * np.linspace(low, high, POINTS)[None, :], np.array(1e-3 * at)
        x, y = (row, number_m) if axis == 0 else (number_m, row)
        made.append(Slice(f"{'yx'[axis]}\u00a0=\u00a0{number(at)}\u00a0mm", f"{'xy'[axis]} (mm)", (low, high, below_mm, 0.0),
                          speed_at(x, y, 1e-3 * z), marks[:, [axis, 2]]))
    return made


def scene(selection: Selection, case: Case) -> list[Slice] | None:
    """The slices of a case with layers, bodies or a map, through the first body or the centre; None without the file of
    the map."""
    medium, domain = case.parameters["medium"], case.parameters["domain"]
    grid: MaterialMap | None = None
    if "map" in medium:
        file = medium_files.file_of(selection.sweep.folder, selection.sweep.job_text, case, "medium.map")
        with contextlib.suppress(OSError, KeyError, ValueError):
            grid = read_map(file) if file else None
        if grid is None:
            return None

    def speed_at(x: np.ndarray, y: np.ndarray, z: np.ndarray) -> np.ndarray:
        c_s = speed(medium, x, y, z)
        if grid is not None:
            mapped = medium_files.speed(grid, x, y, z)
            c_s = np.where(np.isfinite(mapped) & np.isfinite(c_s), mapped, c_s)
        return c_s

    bodies = medium.get("body", [])
    centre = 1e3 * np.array(bodies[0]["centre_m"][:2] if bodies else (0.0, 0.0))
    ends = [(-500.0 * domain["spacing_m"] * domain[n], 500.0 * domain["spacing_m"] * domain[n]) for n in ("nx", "ny")]
    path = wake.focus_at(case, case.focus["time"][-1])[2]
    if grid is None:
        ends = [shown(axis, *ends[axis], path, bodies, depth_mm(medium)) for axis in (0, 1)]
    return slices(ends[0], ends[1], depth_mm(medium), centre, speed_at, np.column_stack([path, np.zeros(len(path))]))


def reach_mm(body: Any, axis: Any) -> Any:
    """How far a body extends from its centre along x (axis 0) or y; 0 if it crosses the whole domain."""
    parts = axes_of(body)[:, axis]
    if "semi_axes_m" in body:
        return 1e3 * math.hypot(*(parts * body["semi_axes_m"]))
    if "size_m" in body:
        return 1e3 * (abs(parts) @ body["size_m"]) / 2
    half = body["length_m"] / 2 if has_ends(body) else 0.0
    return 1e3 * (abs(parts[0]) * half + math.hypot(*parts[1:]) * body["radius_m"])


def shown(axis: int, low: float, high: float, path: np.ndarray, bodies: list[Any], depth: float) -> tuple[float, float]:
    """The part of the domain along an axis with the path and the bodies, and a margin of the depth around them, since the
    layers are uniform beyond."""
    ends = [*path[:, axis]]
    for body in bodies:
        ends += [1e3 * body["centre_m"][axis] + sign * reach_mm(body, axis) for sign in (-1.0, 1.0)]
    return max(low, min(ends) - depth), min(high, max(ends) + depth)


def slices_of(selection: Selection, case: Case) -> list[Slice] | None:
    has_layers = case.setting("medium", "layer", default=[]) and "nx" in case.setting("domain", default={})
    return scene(selection, case) if has_layers else None


def draw(axes: Axes, plane: Slice, norm: Any) -> Any:
    image = axes.imshow(plane.c_s, extent=plane.extent, aspect="equal", norm=norm, interpolation="nearest",
                        cmap=style.sequential_map().with_extremes(bad=RIGID))
    is_point = np.ptp(plane.marks, axis=0).max(initial=0.0) == 0.0
    if not is_point and np.ptp(plane.marks[:, 1]) == 0.0 and plane.marks[0, 1] == 0.0:  # a path on the surface
        axes.plot([plane.marks[:, 0].min(), plane.marks[:, 0].max()], [0.0, 0.0], color=ORANGE, linewidth=3.0,
                  clip_on=False, solid_capstyle="butt")
    else:
        axes.plot(*np.unique(plane.marks, axis=0).T, "o", color=ORANGE, markersize=5 if is_point else 2, clip_on=False)
    axes.set_ylim(plane.extent[2], plane.extent[3])
    hover.attach(axes, plane.c_s, plane.extent[:2], plane.extent[:1:-1], "shear-wave speed", plane.label, "z (mm)", "m/s")
    axes.set_xlabel(plane.label)
    axes.set_ylabel("depth z (mm)")
    return image


def mark_speeds(bar: Any, values: np.ndarray, norm: Any) -> None:
    """Ticks of the colour bar at the speeds of the media; of close speeds only the first."""
    marked = [values[0]]
    for value in values[1:]:
        if norm(value) - norm(marked[-1]) > CLOSE:
            marked.append(value)
    bar.set_ticks(marked, labels=[number(v, 4) for v in marked])
    bar.ax.minorticks_off()


def draw_scale(figure: Any, image: Any, axes: Axes, values: np.ndarray, where: str = "everywhere") -> None:
    """A colour bar for these speeds, or a text if there is only one."""
    if len(values) == 1:
        axes.set_axis_off()
        axes.text(0.5, 0.5, f"The shear-wave speed is {number(values[0], 4)} m/s {where}.", ha="center", va="top",
                  transform=axes.transAxes)
        return
    bar = figure.colorbar(image, cax=axes, orientation="horizontal", label="shear-wave speed (m/s)")
    bar.ax.grid(False)
    if len(values) <= 6:
        mark_speeds(bar, values, image.norm)


def different(selection: Selection) -> list[Case]:
    """The first case of each medium."""
    found: dict[str, Case] = {}
    for case in layout.ordinary(selection):
        key = json.dumps(case.setting("medium", default={}), default=str)
        found.setdefault(key, case)
    return list(found.values())


def figures(selection: Selection) -> list[Figure]:
    every = different(selection)
    pairs = [(c, found) for c in layout.evenly(every, CASES) if (found := slices_of(selection, c))]
    if not pairs:
        return []
    values = np.unique(np.concatenate([np.unique(p.c_s[np.isfinite(p.c_s)]) for _, row in pairs for p in row]))
    low, high = values[0], values[-1] if values[-1] > values[0] else 1.2 * values[0] + 1e-3
    norm = plt.matplotlib.colors.LogNorm(low, high) if high > UNLIKE * low > 0 else plt.Normalize(low, high)
    figure, made, bar_axes = to_scale.arrange(
        [(layout.medium_label(selection, case) if len(every) > 1 else "",
          [(plane.name, plane.extent[1] - plane.extent[0], plane.extent[2] - plane.extent[3]) for plane in row])
         for case, row in pairs])
    image = [draw(axes, plane, norm) for pair, (_, row) in zip(made, pairs) for axes, plane in zip(pair, row)][-1]
    grey = any(is_grey(body) for c, _ in pairs for body in c.parameters["medium"].get("body", []))
    draw_scale(figure, image, bar_axes, values, "outside of the rigid bodies" if grey else "everywhere")
    return [Figure(figure, "medium", "The medium in vertical slices", caption([c for c, _ in pairs], len(every)),
                   "Shear-wave speed over position and depth", cases=[c.id for c, _ in pairs])]


def caption(cases: list[Case], every: int) -> str:
    text = ("Vertical slices of the medium through "
            + ("the first body" if any(c.parameters["medium"].get("body") for c in cases) else "the centre")
            + ", coloured by the shear-wave speed. Orange: path of the focus at the surface.")
    if not any("map" in c.parameters["medium"] for c in cases):
        text += " The layers continue to the ends of the domain."
    if any(c.parameters["medium"].get("body") for c in cases):
        text += " Bodies are drawn as the job defines them; an engine may treat them as rigid or cap their stiffness."
    if any(is_grey(body) for c in cases for body in c.parameters["medium"].get("body", [])):
        text += " Rigid bodies without a shear-wave speed are grey."
    if any("map" in c.parameters["medium"] for c in cases):
        text += " The map is read from its file, which has not changed since the run."
    if len(cases) < every:
        text += f" {len(cases)} of {every} media {'is' if len(cases) == 1 else 'are'} drawn; {OTHERS}."
    return text
