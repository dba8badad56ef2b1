# SPDX-License-Identifier: BSD-3-Clause
"""The picture that explains the efficiency: the focal disc on the wake of plain STM in jobs/quickstart.toml."""
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from shearwake import figure_style, wake
from shearwake.report.load import load
from shearwake.report.words import number

SHOWN_mm = (-56.0, 66.0, -30.0, 30.0)  # left, right, below, above
DISC, REST = "Oranges", "Blues"


def draw_folder(folder: Path, picture: Path) -> None:
    """Draws the last snapshot of the first complete reference."""
    figure_style.reset()
    case = next(c for c in load(folder).cases if c.is_reference and c.is_complete)
    t_s, x, y, u = case.snapshot()
    x_mm, y_mm, radius = 1e3 * x, 1e3 * y, 1e3 * case.setting("measure", "focal_radius_m")
    (focus_x, focus_y), _, _ = wake.focus_at(case, t_s)
    inside = np.hypot(x_mm[:, None] - focus_x, y_mm[None, :] - focus_y) <= radius
    energy = np.sqrt(u**2 / np.max(u[~inside] ** 2))  # the root makes weak waves visible
    figure = plt.figure(figsize=(6.4, 3.15))
    axes = figure.add_axes([0.0, 0.0, 1.0, 1.0])
    axes.set_axis_off()
    axes.imshow(energy.T, origin="lower", cmap=REST, vmin=0.0, vmax=0.8, interpolation="bicubic", extent=wake.extent(x_mm, y_mm))
    disc = plt.Circle((focus_x, focus_y), radius, facecolor=plt.get_cmap(DISC)(0.55), edgecolor=wake.LINE, linewidth=1.2)
    axes.add_patch(disc)
    axes.set(xlim=SHOWN_mm[:2], ylim=SHOWN_mm[2:])
    line = {"arrowstyle": "-", "color": wake.LINE, "linewidth": 0.8}
    axes.annotate("energy in the\nfocal disc", (focus_x, focus_y + radius), (focus_x + 5, 12.5), ha="center", fontsize=10, arrowprops=line)
    axes.text(-53, -27, "energy in the wake", fontsize=10, color=plt.get_cmap(REST)(0.95))
    share = number(100.0 * case.value("eta_at_1"), 2)
    axes.text(-53, 23.5, f"efficiency η = energy in the disc / energy of the whole surface = {share} %", fontsize=10.5)
    figure.savefig(picture, dpi=200, facecolor="white")
    plt.close(figure)
