"""Snapshots of the surface: the reference beside the lowest, a middle and the highest x."""
import math
from dataclasses import dataclass

import matplotlib.pyplot as plt
import numpy as np

import layout
import load
import style
import wake
from figure import Figure
from words import counted, listed, number

ROWS_OF_SERIES = 3  # at most so many series have a figure
LEAST = 0.2
AWAY = 4.0  # focal radii from the focus on: the wake


@dataclass
class Snapshot:
    case: load.Case
    t_s: float
    x_mm: np.ndarray
    y_mm: np.ndarray
    u_um: np.ndarray  # (x, y)


def snapshot(case):
    found = load.surface(case)
    if found is None or not np.any(np.isfinite(found[3])):
        return None
    t_s, x, y, u = found
    return Snapshot(case, t_s, 1e3 * x, 1e3 * y, 1e6 * u)


def chosen(sweep, group):
    """The reference, then the first, a middle and the last case that have a snapshot."""
    count = len(group.cases)
    picks = [group.cases[i] for i in sorted({0, (count - 1) // 2, count - 1})]
    cases = {c.id: c for c in [*layout.references(sweep, group)[:1], *picks]}
    return [s for c in cases.values() if (s := snapshot(c))]


def scale(shots):
    """Where the colours end: the largest |u| away from the focus, so that the wake is seen, and
    LEAST of the peak or more, so that what is at the focus is."""
    outside = []
    for s in shots:
        focus, _, _ = wake.focus_at(s.case, s.t_s)
        radius = AWAY * 1e3 * s.case.setting("measure", "focal_radius_m")
        far = np.ones(s.u_um.shape, dtype=bool)
        for x, y in focus + wake.offsets_mm(s.case):
            far &= np.hypot(s.x_mm[:, None] - x, s.y_mm[None, :] - y) > radius
        outside.append(np.nanmax(np.abs(s.u_um[far])) if far.any() else 0.0)
    end, peak = max(outside), max(np.nanmax(np.abs(s.u_um)) for s in shots)
    if not end > 0.0:
        return peak or 1.0
    return min(peak, max(end, LEAST * peak))


def window(shots, end):
    """The rectangle, common to all, in which anything is seen, and the path with it."""
    low, high = np.full(2, math.inf), np.full(2, -math.inf)
    for s in shots:
        seen = np.abs(s.u_um) > 0.06 * end
        for axis, places in enumerate((s.x_mm, s.y_mm)):
            where = places[seen.any(axis=1 - axis)]
            if len(where):
                low[axis], high[axis] = min(low[axis], where[0]), max(high[axis], where[-1])
        path = wake.focus_at(s.case, s.t_s)[2]
        low, high = np.minimum(low, path.min(axis=0)), np.maximum(high, path.max(axis=0))
    low, high = low - 3.0, high + 3.0
    s = shots[0]
    return (max(low[0], s.x_mm[0]), min(high[0], s.x_mm[-1]), max(low[1], s.y_mm[0]),
            min(high[1], s.y_mm[-1]))


def draw(axes, shot, end, limits):
    dx, dy = np.diff(shot.x_mm[:2])[0] / 2, np.diff(shot.y_mm[:2])[0] / 2
    image = axes.imshow(shot.u_um.T, origin="lower", cmap=style.DIVERGING, vmin=-end, vmax=end,
                        extent=(shot.x_mm[0] - dx, shot.x_mm[-1] + dx, shot.y_mm[0] - dy,
                                shot.y_mm[-1] + dy), interpolation="bicubic",
                        interpolation_stage="data")
    lines = wake.draw_theory(axes, shot.case, shot.t_s)
    axes.set_xlim(*limits[:2])
    axes.set_ylim(*limits[2:])
    axes.set_aspect("equal")
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(True)
    return image, lines


def panel_title(sweep, shot):
    """Which case, and its wake's angle where it was fitted."""
    fitted = shot.case.value("mach_angle_deg")
    angle = "" if math.isnan(fitted) else f" (wake fitted: {number(fitted, 3)}°)"
    return layout.case_label(sweep, shot.case) + angle


def arrange(shots, limits):
    """Axes of equal scale in one or two columns, and those of the colour bar; inches throughout."""
    columns = 1 if len(shots) == 1 else 2
    rows = math.ceil(len(shots) / columns)
    left, right, between, top, bottom = 0.62, 0.12, 0.24, 0.3, 1.28
    width = (style.WIDTH_in - left - right - (columns - 1) * between) / columns
    height = width * (limits[3] - limits[2]) / (limits[1] - limits[0])
    if height > 5.0:
        left += 0.5 * columns * width * (1.0 - 5.0 / height)
        width, height = width * 5.0 / height, 5.0
    total = top + rows * height + (rows - 1) * 0.36 + bottom
    figure = plt.figure(figsize=(style.WIDTH_in, total))
    made = []
    for i in range(len(shots)):
        row, column = divmod(i, columns)
        place = (left + column * (width + between), bottom + (rows - 1 - row) * (height + 0.36),
                 width, height)
        made.append(figure.add_axes([place[0] / style.WIDTH_in, place[1] / total,
                                     place[2] / style.WIDTH_in, place[3] / total]))
        made[-1].tick_params(labelleft=column == 0, labelbottom=i + columns >= len(shots))
        if column == 0:
            made[-1].set_ylabel("y (mm)")
        if i + columns >= len(shots):
            made[-1].set_xlabel("x (mm)")
    bar = figure.add_axes([0.22, 0.5 / total, 0.56, 0.13 / total])
    return figure, made, bar


def surface_figure(sweep, folder, group, name):
    shots = chosen(sweep, group)
    if not shots:
        return None
    end = scale(shots)
    limits = window(shots, end)
    figure, made, bar_axes = arrange(shots, limits)
    any_lines = False
    for axes, shot in zip(made, shots):
        image, lines = draw(axes, shot, end, limits)
        any_lines = any_lines or lines
        axes.set_title(panel_title(sweep, shot), loc="left", pad=4)
    peak = max(np.nanmax(np.abs(s.u_um)) for s in shots)
    clipped = peak > 1.001 * end
    label = "u_z (µm), positive into the tissue".replace("u_z", "$u_z$")
    if clipped:
        label += f"; clipped at ±{number(end, 2)}, the focus reaches {number(peak, 3)}"
    bar = figure.colorbar(image, cax=bar_axes, orientation="horizontal", label=label,
                          extend="both" if clipped else "neither")
    bar.outline.set_linewidth(0.5)
    bar_axes.grid(False)
    style.save(figure, folder / (name + ".png"))
    times = listed(sorted({number(1e3 * s.t_s) + " ms" for s in shots}))
    of_series = f", {group.label}" if len(layout.groups(sweep)) > 1 else ""
    title = f"The surface at {times}{of_series}"
    return Figure(name, title, caption(shots, any_lines, clipped), title + ", seen from above")


def caption(shots, any_lines, clipped):
    text = ("Displacement of the surface seen from above, one colour scale for all; circle: the "
            "focal disc; dotted: the path travelled.")
    if clipped:
        text += (f" The scale ends at the largest displacement beyond {number(AWAY)} focal radii "
                 "from the focus, so that the wake can be seen, or at a fifth of the peak; what "
                 "exceeds it is clipped.")
    if any_lines:
        angles = {number(s.case.value("mach_angle_theory_deg"), 3) for s in shots} - {""}
        text += (" Dashed: the theoretical Mach lines, sin θ = Rayleigh speed / focus speed at "
                 f"that instant, θ = {listed(a + '°' for a in sorted(angles))}, as long as the "
                 "path has made them.")
    without = {}
    for s in shots:
        if reason := s.case.notes.get("mach_angle_theory_deg"):
            without.setdefault(reason, []).append(s.case)
    for reason, cases in without.items():
        which = f" in {counted(len(cases), 'panel')}" if any_lines else ""
        text += f" No Mach lines{which}: {reason}."
    return text


def figures(sweep, folder):
    found = layout.groups(sweep)
    picks = sorted({0, (len(found) - 1) // 2, len(found) - 1})[:ROWS_OF_SERIES] if found else []
    names = ["surface"] + [f"surface_{i}" for i in range(2, len(picks) + 1)]
    made = [surface_figure(sweep, folder, found[g], n) for g, n in zip(picks, names)]
    return [f for f in made if f]
