# SPDX-License-Identifier: BSD-3-Clause
"""Draws the path, the focal disc and the theoretical Mach lines into a snapshot."""
import math

import numpy as np

import style

LINE = "#111111"


def offsets_mm(case):
    """Offsets of simultaneous foci from the moving point; zero for a single focus."""
    x = case.setting("load", "modulation", "foci_x_m", default=[0.0])
    y = case.setting("load", "modulation", "foci_y_m", default=[0.0])
    return 1e3 * np.column_stack([x, y])


def runs_straight_on(case):
    """Whether a single focus moves once along a straight line, so that it draws no shape."""
    if len(case.setting("load", "modulation", "foci_x_m", default=[0.0])) > 1:
        return False
    path = np.column_stack([case.series["focus_x"], case.series["focus_y"]])
    way = path[-1] - path[0]
    length = float(np.hypot(*way))
    if not length > 0:
        return False
    off = np.abs((path - path[0]) @ np.array([-way[1], way[0]])) / length
    on = np.diff(path @ way)
    return bool(off.max() < 1e-6 * length and (on >= 0).all())


def passing_ms(case):
    """The time at which the moving focus is nearest to the trace if it passes it exactly once, else None."""
    radius = case.setting("measure", "focal_radius_m")
    distance = np.hypot(case.series["focus_x"] - case.trace_at_m[0],
                        case.series["focus_y"] - case.trace_at_m[1])
    covered = distance <= radius
    entries = np.count_nonzero(np.diff(covered.astype(int)) == 1) + int(covered[0])
    return None if entries != 1 or covered.all() else 1e3 * case.series["time"][distance.argmin()]


def is_passed(case):
    """Whether the focal disc ever covers the trace."""
    distance = np.hypot(case.series["focus_x"] - case.trace_at_m[0],
                        case.series["focus_y"] - case.trace_at_m[1])
    return bool((distance <= case.setting("measure", "focal_radius_m")).any())


def last_pressed(case):
    """Index of the last frame with a force, since a path that has ended exerts none."""
    force = case.series.get("force")
    pressed = np.flatnonzero(force) if force is not None else ()
    return int(pressed[-1]) if len(pressed) else len(case.series["time"]) - 1


def is_over(case, t_s):
    """Whether the load has ended before this time."""
    return int(np.argmin(np.abs(case.series["time"] - t_s))) > last_pressed(case) + 1


def focus_at(case, t_s):
    """Position of the focus in mm, its unit direction of motion (None at rest) and its path up to time t_s.
    After the end of the load, the last values."""
    time = case.series["time"]
    path = 1e3 * np.column_stack([case.series["focus_x"], case.series["focus_y"]])
    now = min(int(np.argmin(np.abs(time - t_s))), last_pressed(case))
    before = max(0, min(now, len(time) - 1) - 1)
    step = path[now] - path[before] if now > before else path[min(1, len(path) - 1)] - path[0]
    length = float(np.hypot(*step))
    return path[now], step / length if length > 1e-9 else None, path[: now + 1]


def fronts(focus, direction, angle_deg, length):
    """The two Mach lines behind the focus at +- angle from the reversed direction of motion."""
    for sign in (1.0, -1.0):
        a = math.pi + sign * math.radians(angle_deg)
        turned = np.array([math.cos(a) * direction[0] - math.sin(a) * direction[1],
                           math.sin(a) * direction[0] + math.cos(a) * direction[1]])
        yield np.array([focus, focus + length * turned])


def front_length(case, focus, path, angle_deg):
    """Length of a Mach line, whose far end was emitted at the start of the path."""
    return float(np.hypot(*(focus - path[0]))) * math.cos(math.radians(angle_deg))


def draw_theory(axes, case, t_s, width=1.0):
    """Draws path, focal disc and Mach lines; after the end of the load only the path. Returns whether Mach
    lines were drawn."""
    focus, direction, path = focus_at(case, t_s)
    radius = 1e3 * case.setting("measure", "focal_radius_m")
    around = np.linspace(0.0, 2.0 * np.pi, 100)
    for offset in offsets_mm(case):
        if len(path) > 1 and np.ptp(path, axis=0).max() > 0:
            axes.plot(*(path + offset).T, color=LINE, linewidth=0.7 * width, linestyle=(0, (1, 2)))
        if is_over(case, t_s):
            continue
        x, y = focus + offset
        axes.plot(x + radius * np.cos(around), y + radius * np.sin(around), color=LINE,
                  linewidth=1.3 * width, path_effects=style.halo(2.6 * width))
        axes.plot(x, y, "o", color=LINE, markersize=2.0 * width)
    angle = case.value("mach_angle_theory_deg")
    if direction is None or math.isnan(angle) or is_over(case, t_s):
        return False
    length = front_length(case, focus, path, angle)
    for line in fronts(focus, direction, angle, length):
        start = line[0] + (line[1] - line[0]) * min(1.0, radius / max(length, 1e-9))
        axes.plot(*np.array([start, line[1]]).T, color=LINE, linewidth=1.1 * width,
                  linestyle=(0, (6, 4)), path_effects=style.halo(2.0 * width))
    return True
