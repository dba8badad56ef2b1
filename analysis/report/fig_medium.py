# SPDX-License-Identifier: BSD-3-Clause
"""Vertical slices of the medium: its layers and bodies, with the path of the focus at the surface."""
import json
import math

import matplotlib.pyplot as plt
import numpy as np

import layout
import style
import wake
from figure import Figure
from words import number

CASES = 4
POINTS = 240         # of a slice along its longer side
HALF_SPACE_mm = 20.0  # depth drawn of a half-space without deeper bodies
UNLIKE = 20.0        # largest ratio of shear-wave speeds on a linear colour scale


def is_inside(body, x, y, z):
    """Whether points in m are within the body; its smooth edge counts up to its middle."""
    cx, cy, cz = body["centre_m"]
    x, y, z = x - cx, y - cy, z - cz
    if body["shape"] == "ellipsoid":
        a, b, c = body["semi_axes_m"]
        return (x / a)**2 + (y / b)**2 + (z / c)**2 <= 1.0
    if body["shape"] == "box":
        a, b, c = body["size_m"]
        return (abs(x) <= a / 2) & (abs(y) <= b / 2) & (abs(z) <= c / 2)
    turn = math.radians(body.get("azimuth_deg", 0.0))
    if body.get("axis") == "vertical":
        along, across, up = z, x, y
    else:
        along, across, up = x * math.cos(turn) + y * math.sin(turn), y * math.cos(turn) - x * math.sin(turn), z
    length = body.get("length_m", 0.0)
    within = abs(along) <= length / 2 if 0.0 < length < math.inf else np.ones_like(across, dtype=bool)
    return (across**2 + up**2 <= body["radius_m"]**2) & within


def speed(medium, x, y, z):
    """The shear-wave speed in m/s at points in m. A later body covers an earlier one."""
    c_s, top = np.full(np.broadcast(x, y, z).shape, math.nan), 0.0
    layers = medium["layer"]
    for n, layer in enumerate(layers):
        endless = n == len(layers) - 1 and medium.get("base") == "half-space"
        below = math.inf if endless else top + layer["thickness_m"]
        c_s[np.broadcast_to((z >= top) & (z <= below), c_s.shape)] = layer["c_s_m_s"]
        top = below
    for body in medium.get("body", []):
        c_s[is_inside(body, *np.broadcast_arrays(x, y, z))] = body["c_s_m_s"]
    return c_s


def depth_mm(medium):
    """The depth that is drawn: down to the base, or below the deepest interface of a half-space."""
    total = 1e3 * sum(layer.get("thickness_m", 0.0) for layer in medium["layer"])
    if medium.get("base") != "half-space":
        return total
    deepest = max((1e3 * body["centre_m"][2] for body in medium.get("body", [])), default=0.0)
    return max(HALF_SPACE_mm, 1.3 * total, 1.5 * deepest)


def planes(case):
    """The slices: (title, label of the horizontal axis, extent in mm, c_s(z, horizontal), path in mm). They cross the
    first body, or the centre of the domain."""
    medium, domain = case.physics["medium"], case.physics["domain"]
    bodies = medium.get("body", [])
    x0, y0 = bodies[0]["centre_m"][:2] if bodies else (0.0, 0.0)
    wide, deep = (1e3 * domain["spacing_m"] * domain[n] for n in ("nx", "ny"))
    below = depth_mm(medium)
    z = np.linspace(0.0, below, POINTS)[:, None]
    path = wake.focus_at(case, case.series["time"][-1])[2]
    made = []
    for axis, width, at in ((0, wide, y0), (1, deep, x0)):
        places = np.linspace(-width / 2, width / 2, POINTS)[None, :]
        x, y = (places * 1e-3, np.array(at)) if axis == 0 else (np.array(at), places * 1e-3)
        made.append((f"{'yx'[axis]} = {number(1e3 * at)} mm", f"{'xy'[axis]} (mm)",
                     (-width / 2, width / 2, below, 0.0), speed(medium, x, y, z * 1e-3), path[:, axis]))
    return made


def has_slices(case):
    medium = case.setting("medium", default={})
    return bool(medium.get("layer")) and "map" not in medium and "nx" in case.setting("domain", default={})


def draw(axes, plane, norm, title):
    name, label, extent, c_s, path = plane
    image = axes.imshow(c_s, extent=extent, aspect="auto", cmap=style.sequential_map(), norm=norm,
                        interpolation="nearest")
    axes.plot([path.min(), path.max()], [0.0, 0.0], color="#D55E00", linewidth=3.0, clip_on=False,
              marker="o" if np.ptp(path) == 0 else "", solid_capstyle="butt")
    axes.set_xlabel(label)
    axes.set_title(title + name, loc="left", fontsize=9)
    axes.grid(False)
    return image


def figures(sweep, folder):
    every = {json.dumps([c.physics["medium"], c.physics["domain"]["nx"]]): c
             for c in reversed(layout.ordinary(sweep)) if has_slices(c)}
    cases = layout.evenly(list(reversed(every.values())), CASES)
    if not cases:
        return []
    rows = [planes(c) for c in cases]
    values = np.unique(np.concatenate([np.unique(p[3][np.isfinite(p[3])]) for row in rows for p in row]))
    logarithmic = values[-1] > UNLIKE * values[0] > 0
    norm = (plt.matplotlib.colors.LogNorm if logarithmic else plt.Normalize)(
        values[0], values[-1] if len(values) > 1 else 1.2 * values[0])
    figure, made = plt.subplots(len(rows), 2, squeeze=False, layout="constrained", sharex="col",
                                figsize=(style.WIDTH_in, 0.9 + 1.75 * len(rows)))
    for axes, row, case in zip(made, rows, cases):
        label = layout.case_label(sweep, case) + "\n" if len(every) > 1 else ""
        image = draw(axes[0], row[0], norm, layout.wrapped(label, 3.4) + "\n" if label else "")
        draw(axes[1], row[1], norm, "")
        axes[0].set_ylabel("depth z (mm)")
    bar = figure.colorbar(image, ax=made.ravel().tolist(), label="shear-wave speed (m/s)", shrink=0.9)
    bar.ax.grid(False)
    if len(values) <= 6:
        bar.set_ticks(values, labels=[number(v, 4) for v in values])
        bar.ax.minorticks_off()
    style.save(figure, folder / "medium.png")
    text = ("Vertical slices of the medium through "
            + ("the first body" if any(c.physics["medium"].get("body") for c in cases) else "the centre")
            + ", coloured by the shear-wave speed. Orange: path of the focus at the surface. The axes have "
            "different scales. Bodies are drawn as the job defines them; an engine may cap their stiffness.")
    if len(cases) < len(every):
        text += f" {len(cases)} of {len(every)} media are drawn."
    return [Figure("medium", "The medium in vertical slices", text, "Shear-wave speed over position and depth")]
