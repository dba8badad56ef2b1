# SPDX-License-Identifier: BSD-3-Clause
"""Slices of recorded volumes: vertical through the focus, and horizontal below the surface."""

import matplotlib.pyplot as plt
import numpy as np

import hover
import layout
import style
from package import UNREADABLE, wake
import warnings_of
from figure import Figure
from words import counted, number

CASES = 4
BELOW = 0.25  # depth of the horizontal slice relative to the depth of the volume


def last_volume(case):
    """t_s, the name of the component, x, y, z in mm and the last volume (z, y, x) in um; None without volumes."""
    try:
        names = case.stored.dimensions("volume")
        name = next(n for n in ("u_z", "u_x", "u_y") if n in names)
        return (float(case.stored.array("volume/time", -1)), name,
                *(1e3 * case.stored.array(f"volume/{axis}") for axis in "xyz"), 1e6 * case.stored.array(f"volume/{name}", -1))
    except (*UNREADABLE, StopIteration):
        return None


def draw(axes, horizontal, vertical, values, end, labels):
    image = axes.pcolormesh(horizontal, vertical, values, cmap=style.DIVERGING, vmin=-end, vmax=end,
                            shading="nearest", rasterized=True)
    axes.grid(False)
    hover.attach(axes, on_even_rows(values, vertical), (horizontal[0], horizontal[-1]), (vertical[0], vertical[-1]), "u",
                 *labels, "µm")
    return image


def on_even_rows(values, vertical):
    """The rows nearest to even steps; the planes of a volume may be closer near the surface."""
    even = np.linspace(vertical[0], vertical[-1], 72)
    return values[np.abs(vertical[:, None] - even[None, :]).argmin(axis=0)]


def row_of(axes, case, volume, end):
    """Draws the two slices of a case. Returns the image and the place of the vertical slice."""
    t_s, _, x, y, z, u = volume
    focus = wake.focus_at(case, t_s)[0]
    j, k = int(np.abs(y - focus[1]).argmin()), int(np.abs(z - BELOW * z[-1]).argmin())
    image = draw(axes[0], x, z, u[:, j, :], end, ("x (mm)", "z (mm)"))
    axes[0].set_ylim(z[-1], z[0])
    axes[0].set_ylabel("depth z (mm)")
    draw(axes[1], x, y, u[k], end, ("x (mm)", "y (mm)"))
    axes[1].set_ylabel("y (mm)")
    axes[1].set_title(f"z = {number(z[k], 3)} mm", loc="left", fontsize=9)
    return image, f"y = {number(y[j], 3)} mm"


def figures(sweep, folder):
    candidates = [c for c in layout.ordinary(sweep) if c.setting("record", "volumes_s", default=[])]
    found = [(c, v) for c in layout.evenly(candidates, CASES) if (v := last_volume(c))]
    if not found:
        return []
    # The focus would hide the waves below it: the scale ends at the 99.5th percentile.
    end = max(float(np.nanpercentile(np.abs(v[5]), 99.5)) for _, v in found) or 1.0
    figure, made = plt.subplots(len(found), 2, squeeze=False, sharex=True, layout="constrained",
                                figsize=(style.WIDTH_in, 0.9 + 2.1 * len(found)))
    for axes, (case, volume) in zip(made, found):
        image, place = row_of(axes, case, volume, end)
        label = layout.wrapped(f"{warnings_of.label(sweep, case, 'volume')}, t = {number(1e3 * volume[0])} ms", 3.6)
        axes[0].set_title(f"{label}\n{place}", loc="left", fontsize=9)
    for axes in made[-1]:
        axes.set_xlabel("x (mm)")
    component = found[0][1][1]
    bar = figure.colorbar(image, ax=made.ravel().tolist(), label=f"{component} (µm)", shrink=0.8, extend="both")
    bar.ax.grid(False)
    style.save(figure, folder / "volume.png")
    text = (f"The component {component} of the displacement in the last recorded volume. Left: vertical slice through "
            f"the focus. Right: horizontal slice. The colour scale ends at ±{number(end, 2)} µm, the 99.5th percentile; "
            "larger values are clipped.")
    if len(found) < len(candidates):
        text += f" {len(found)} of {counted(len(candidates), 'case')} with volumes {'is' if len(found) == 1 else 'are'} drawn."
    return [Figure("volume", "Slices of the recorded volumes", text, "Displacement over position and depth",
                   maps=hover.maps_of(figure), cases=[case.id for case, _ in found])]
