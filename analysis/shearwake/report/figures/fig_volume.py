# SPDX-License-Identifier: BSD-3-Clause
"""Slices of recorded volumes: vertical through the focus, and horizontal below the surface."""
from __future__ import annotations

from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ... import wake
from ...case import Case
from ...errors import NotRecorded
from .. import layout, style, warnings_of
from ..figure import Figure
from ..load import Selection
from ..page import hover
from ..words import number, strongest_text
from . import to_scale

CASES = 4
BELOW = 0.25  # depth of the horizontal slice relative to the depth of the volume


def last_volume(case: Case) -> Any:
    """t_s, the name of the component, x, y, z in mm and the last volume (z, y, x) in um; None without volumes."""
    try:
        names = case.dimensions("volume")
        name = next(n for n in ("u_z", "u_x", "u_y") if n in names)
        return (float(case.array("volume/time", -1)), name,
                *(1e3 * case.array(f"volume/{axis}") for axis in "xyz"), 1e6 * case.array(f"volume/{name}", -1))
    except (NotRecorded, StopIteration):
        return None


def draw(axes: Axes, horizontal: Any, vertical: Any, values: Any, end: Any, labels: Any) -> Any:
    image = axes.pcolormesh(horizontal, vertical, values, cmap=style.DIVERGING, vmin=-end, vmax=end,
                            shading="nearest", rasterized=True)
    axes.grid(False)
    hover.attach(axes, on_even_rows(values, vertical), (horizontal[0], horizontal[-1]), (vertical[0], vertical[-1]), "u",
                 labels[0], labels[1], "µm")
    return image


def on_even_rows(values: Any, vertical: Any) -> Any:
    """The rows nearest to even steps; the planes of a volume may be closer near the surface."""
    even = np.linspace(vertical[0], vertical[-1], 72)
    return values[np.abs(vertical[:, None] - even[None, :]).argmin(axis=0)]


def focus_mm(case: Case, volume: Any) -> Any:
    t_s, _, x, y, _, u = volume

    def largest(x_mm: Any, y_mm: Any) -> Any:
        """The largest displacement at any depth in the columns of the grid that are nearest to points."""
        i, j = (np.abs(axis[:, None] - points).argmin(axis=0) for axis, points in ((x, x_mm), (y, y_mm)))
        return np.abs(u[:, j, i]).max(axis=0)

    return wake.strongest_focus_mm(case, t_s, largest)


def planes(case: Case, volume: Any) -> Any:
    """The indices (j, k) of the planes of the two slices."""
    y, z = volume[3:5]
    focus = focus_mm(case, volume)
    return int(np.abs(y - focus[1]).argmin()), int(np.abs(z - BELOW * z[-1]).argmin())


def row_of(selection: Selection, case: Case, volume: Any) -> Any:
    """The slices of a case, for to_scale.arrange()."""
    t_s, _, x, y, z, _ = volume
    j, k = planes(case, volume)
    label = f"{warnings_of.label(selection, case, 'volume')}, t\u00a0=\u00a0{number(1e3 * t_s)}\u00a0ms"
    return label, ((f"y\u00a0=\u00a0{number(y[j], 3)}\u00a0mm", np.ptp(x), np.ptp(z)),
                   (f"z\u00a0=\u00a0{number(z[k], 3)}\u00a0mm", np.ptp(x), np.ptp(y)))


def draw_row(pair: Any, case: Case, volume: Any, end: Any) -> Any:
    """Draws the slices of a case and returns the image of the first."""
    _, _, x, y, z, u = volume
    j, k = planes(case, volume)
    image = draw(pair[0], x, z, u[:, j, :], end, ("x (mm)", "z (mm)"))
    pair[0].set_ylim(z[-1], z[0])
    pair[0].set_ylabel("depth z (mm)")
    draw(pair[1], x, y, u[k], end, ("x (mm)", "y (mm)"))
    pair[1].set_ylim(y[0], y[-1])
    pair[1].set_ylabel("y (mm)")
    for axes in pair:
        axes.set_xlim(x[0], x[-1])
        axes.set_aspect("equal")
        axes.set_xlabel("x (mm)")
    return image


def figures(selection: Selection) -> list[Any]:
    candidates = [c for c in layout.ordinary(selection) if c.setting("record", "volumes_s", default=[])]
    found = [(c, v) for c in layout.evenly(candidates, CASES) if (v := last_volume(c))]
    if not found:
        return []
    # The focus would hide the waves below it: the scale ends at the 99.5th percentile.
    end = max(float(np.nanpercentile(np.abs(v[5]), 99.5)) for _, v in found) or 1.0
    figure, made, bar_axes = to_scale.arrange([row_of(selection, *item) for item in found])
    image = [draw_row(pair, *item, end) for pair, item in zip(made, found)][-1]
    component = found[0][1][1]
    bar = figure.colorbar(image, cax=bar_axes, orientation="horizontal", label=f"{component} (µm)", extend="both")
    bar.ax.grid(False)
    text = (f"The component {component} of the displacement in the last recorded volume: a vertical slice through the focus, and "
            f"a horizontal slice. The colour scale ends at ±{number(end, 2)} µm, the 99.5th percentile; larger values are "
            "clipped." + strongest_text(focus_mm(*one) for one in found if len(wake.offsets_mm(one[0])) > 1))
    return [Figure(figure, "volume", "Slices of the recorded volumes", text, "Displacement over position and depth",
                   cases=[case.id for case, _ in found])]
