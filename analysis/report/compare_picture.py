# SPDX-License-Identifier: BSD-3-Clause
"""Draws two surfaces and their difference."""
import matplotlib.pyplot as plt
import numpy as np

import compare_words
import load
import style
from compare_fields import common_times, on_common_grid
from words import number


def surfaces(pair, time_ms):
    """The surfaces of both cases at this time on the common grid, in mm and um."""
    a, b = pair
    i, j = next((i, j) for i, j in common_times(load.surface_times(a), load.surface_times(b))
                if abs(1e3 * load.surface_times(a)[i] - time_ms) < 1e-6)
    x, y, u, v = on_common_grid(load.surface(a, i), load.surface(b, j))
    return 1e3 * x, 1e3 * y, 1e6 * u, 1e6 * v


def panel(axes, x, y, u, title):
    end = float(np.abs(u).max()) or 1.0
    half_x, half_y = 0.5 * (x[1] - x[0]), 0.5 * (y[1] - y[0])
    image = axes.imshow(u.T, origin="lower", cmap=style.DIVERGING, vmin=-end, vmax=end,
                        extent=(x[0] - half_x, x[-1] + half_x, y[0] - half_y, y[-1] + half_y))
    axes.set_title(title, loc="left", fontsize=9)
    axes.set_xlabel("x (mm)")
    axes.grid(False)
    return image


def draw(result, pairs, path):
    """The pair that differs most, at the time of the largest relative L2. Raises ValueError without a common
    surface."""
    chosen = compare_words.worst(result["pairs"])
    if not chosen["fields"]:
        raise ValueError("the two have no surface at a common time to draw; record.snapshots_ms selects the times")
    field = max(chosen["fields"], key=lambda f: f["relative_l2"])
    pair = pairs[result["pairs"].index(chosen)]
    x, y, u, v = surfaces(pair, field["time_ms"])
    width = 1.4 * style.WIDTH_in
    height = min(0.29 * width * np.ptp(y) / np.ptp(x), 0.8 * width) + 2.0  # titles and colour bars
    figure, made = plt.subplots(1, 3, layout="constrained", sharey=True, figsize=(width, height))
    titles = ["first", "second"] if pair[0].id == pair[1].id else [c.id for c in pair]
    engines = [f"\n{e}, {g['spacing_mm']:g} mm" for e, g in zip(chosen["engines"], chosen["grids"])]
    titles = [*(t + e for t, e in zip(titles, engines)),
              f"difference\nrelative L2 {compare_words.percent(field['relative_l2'])}"]
    for axes, values, title in zip(made, (u, v, u - v), titles):
        image = panel(axes, x, y, values, title)
        bar = figure.colorbar(image, ax=axes, orientation="horizontal", label="$u_z$ (µm)", shrink=0.9)
        bar.outline.set_linewidth(0.5)
    made[2].plot(*field["at_mm"], "o", color=style.INK, markersize=9, markerfacecolor="none")
    made[2].annotate(f"{number(field['largest_um'], 3)} µm", field["at_mm"], textcoords="offset points",
                     xytext=(8, 8), fontsize=8, path_effects=style.halo(2.0, "white"))
    made[0].set_ylabel("y (mm)")
    figure.suptitle(f"The surfaces at {number(field['time_ms'])} ms", x=0.01, ha="left", fontsize=10)
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=150)
    plt.close(figure)
