# SPDX-License-Identifier: BSD-3-Clause
"""The path of the focus, the focal disc and the theoretical Mach lines, and their drawing into a snapshot.
"""
from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from typing import Any, Protocol

import numpy as np

LINE = "#111111"
AWAY = 4.0  # distance from the focus, in focal radii, beyond which the field is the wake
LEAST = 0.2  # smallest end of the colour scale relative to the peak


class CaseInterface(Protocol):
    """What pictures need of a case."""

    id: str

    @property
    def is_valid(self) -> bool: ...

    @property
    def focus(self) -> dict[str, np.ndarray]: ...

    @property
    def over_time(self) -> dict[str, np.ndarray]: ...

    def setting(self, *keys: str, default: Any = ...) -> Any: ...

    def value(self, column: str, default: Any = ...) -> float: ...

    def array(self, name: str, index: Any = ()) -> np.ndarray: ...

    def snapshot(self, index: int = -1) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]: ...


def halo(width: float = 2.5, colour: str = "white") -> list[Any]:
    """A path effect that outlines a line or a text."""
    from matplotlib import patheffects
    return [patheffects.withStroke(linewidth=width, foreground=colour)]


def extent(x: np.ndarray, y: np.ndarray) -> tuple[float, float, float, float]:
    """The edges of a picture of values at equidistant points: left, right, bottom, top."""
    half_x, half_y = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    return x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y


def offsets_mm(case: CaseInterface) -> np.ndarray:
    """Offsets of simultaneous foci from the moving point; zero for a single focus."""
    x = case.setting("load", "modulation", "foci_x_m", default=[0.0])
    y = case.setting("load", "modulation", "foci_y_m", default=[0.0])
    return 1e3 * np.column_stack([x, y])


def runs_straight_on(case: CaseInterface) -> bool:
    """Whether a single focus moves once along a straight line, so that it draws no shape."""
    if len(case.setting("load", "modulation", "foci_x_m", default=[0.0])) > 1:
        return False
    path: np.ndarray = np.column_stack([case.focus["focus_x"], case.focus["focus_y"]])
    direction = path[-1] - path[0]
    length = float(np.hypot(*direction))
    if not length > 0:
        return False
    off = np.abs((path - path[0]) @ np.array([-direction[1], direction[0]])) / length
    on = np.diff(path @ direction)
    return bool(off.max() < 1e-6 * length and (on >= 0).all())


def passing_ms(case: CaseInterface, x_m: float, y_m: float) -> float | None:
    """The time at which the moving focus is nearest to a point if it passes it exactly once, else None."""
    radius = case.setting("measure", "focal_radius_m")
    distance = np.hypot(case.focus["focus_x"] - x_m, case.focus["focus_y"] - y_m)
    covered = distance <= radius
    entries = np.count_nonzero(np.diff(covered.astype(int)) == 1) + int(covered[0])
    return None if entries != 1 or covered.all() else 1e3 * case.focus["time"][distance.argmin()]


def is_passed(case: CaseInterface, x_m: float, y_m: float) -> bool:
    """Whether the focal disc ever covers a point."""
    distance = np.hypot(case.focus["focus_x"] - x_m, case.focus["focus_y"] - y_m)
    return bool((distance <= case.setting("measure", "focal_radius_m")).any())


def last_pressed(case: CaseInterface) -> int:
    """Index of the last frame with a force, since a path that has ended exerts none."""
    pressed: Any = np.flatnonzero(case.focus["force"]) if "force" in case.focus else ()
    return int(pressed[-1]) if len(pressed) else len(case.focus["time"]) - 1


def is_over(case: CaseInterface, t_s: float) -> bool:
    """Whether the load has ended before this time."""
    return int(np.argmin(np.abs(case.focus["time"] - t_s))) > last_pressed(case) + 1


def focus_at(case: CaseInterface, t_s: float) -> tuple[np.ndarray, np.ndarray | None, np.ndarray]:
    """Position of the focus in mm, its unit direction of motion (None at rest) and its path up to time t_s.
    After the end of the load, the last values."""
    time = case.focus["time"]
    path = 1e3 * np.column_stack([case.focus["focus_x"], case.focus["focus_y"]])
    now = min(int(np.argmin(np.abs(time - t_s))), last_pressed(case))
    before = max(0, min(now, len(time) - 1) - 1)
    step = path[now] - path[before] if now > before else path[min(1, len(path) - 1)] - path[0]
    length = float(np.hypot(*step))
    return path[now], step / length if length > 1e-9 else None, path[: now + 1]


def strongest_focus_mm(case: CaseInterface, t_s: float, displacement: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> np.ndarray:
    """The position of the focus; of several simultaneous foci that with the largest displacement(x_mm, y_mm), the first
    of those that differ by rounding only."""
    foci = focus_at(case, t_s)[0] + offsets_mm(case)
    sizes = np.nan_to_num(np.abs(displacement(foci[:, 0], foci[:, 1])), nan=-1.0)
    return foci[np.argmax(sizes >= sizes.max() - 1e-6 * abs(sizes.max()))]


def fronts(focus: np.ndarray, direction: np.ndarray, angle_deg: float, length: float) -> Iterator[np.ndarray]:
    """The two Mach lines behind the focus at +- angle from the reversed direction of motion."""
    for sign in (1.0, -1.0):
        a = math.pi + sign * math.radians(angle_deg)
        turned = np.array([math.cos(a) * direction[0] - math.sin(a) * direction[1],
                           math.sin(a) * direction[0] + math.cos(a) * direction[1]])
        yield np.array([focus, focus + length * turned])


def front_length(case: CaseInterface, focus: np.ndarray, path: np.ndarray, angle_deg: float) -> float:
    """Length of a Mach line, whose far end was emitted at the start of the path."""
    return float(np.hypot(*(focus - path[0]))) * math.cos(math.radians(angle_deg))


def draw_theory(axes: Any, case: CaseInterface, t_s: float) -> bool:
    """Draws path, focal disc and Mach lines; after the end of the load only the path. Returns whether Mach
    lines were drawn."""
    focus, direction, path = focus_at(case, t_s)
    radius = 1e3 * case.setting("measure", "focal_radius_m")
    around = np.linspace(0.0, 2.0 * np.pi, 100)
    for offset in offsets_mm(case):
        if len(path) > 1 and np.ptp(path, axis=0).max() > 0:
            axes.plot(*(path + offset).T, color=LINE, linewidth=0.7, linestyle=(0, (1, 2)))
        if is_over(case, t_s):
            continue
        x, y = focus + offset
        axes.plot(x + radius * np.cos(around), y + radius * np.sin(around), color=LINE, linewidth=1.3, path_effects=halo(2.6))
        axes.plot(x, y, "o", color=LINE, markersize=2.0)
    angle = case.value("mach_angle_theory_deg", math.nan)  # a scan has no such column
    if direction is None or math.isnan(angle) or is_over(case, t_s):
        return False
    length = front_length(case, focus, path, angle)
    for line in fronts(focus, direction, angle, length):
        start = line[0] + (line[1] - line[0]) * min(1.0, radius / max(length, 1e-9))
        axes.plot(*np.array([start, line[1]]).T, color=LINE, linewidth=1.1, linestyle=(0, (6, 4)), path_effects=halo(2.0))
    return True


def scale_end(shots: list[tuple[CaseInterface, float, np.ndarray, np.ndarray, np.ndarray]]) -> float:
    """End of the colour scale of snapshots (case, t_s, x_mm, y_mm, u_um): the largest |u| away from the focus, so that the
    wake is visible, but at least LEAST times the peak, so that the focus remains distinguishable."""
    outside = []
    for case, t_s, x_mm, y_mm, u_um in shots:
        focus, _, _ = focus_at(case, t_s)
        radius = AWAY * 1e3 * case.setting("measure", "focal_radius_m")
        far = np.ones(u_um.shape, dtype=bool)
        for x, y in focus + offsets_mm(case):
            far &= np.hypot(x_mm[:, None] - x, y_mm[None, :] - y) > radius
        outside.append(float(np.nanmax(np.abs(u_um[far]))) if far.any() else 0.0)
    end, peak = max(outside), max(float(np.nanmax(np.abs(shot[4]))) for shot in shots)
    if not end > 0.0:
        return peak or 1.0
    return min(peak, max(end, LEAST * peak))
