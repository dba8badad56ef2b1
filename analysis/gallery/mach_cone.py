# SPDX-License-Identifier: BSD-3-Clause
"""The annotated picture of jobs/mach-cone.toml."""
from pathlib import Path

import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from shearwake import figure_style, wake
from shearwake.report import style
from shearwake.report.figures.fig_surface import Snapshot, snapshot
from shearwake.report.load import load
from shearwake.report.words import number

SIZE_px, DPI = (1600, 1040), 200
SHOWN_mm = (-80.0, 68.0, -51.0, 51.0)  # left, right, below, above
SCALE_end_um = 1.0  # end of the colour scale; the displacement at the focus is larger


def arrow_and_words(axes: Axes, shot: Snapshot, speed_m_s: float, angle_deg: float) -> None:
    """Labels of the focus, the Mach line and the echo, in the region at rest."""
    focus, direction, _ = wake.focus_at(shot.case, shot.t_s)
    assert direction is not None
    axes.annotate("", focus + 15 * direction, focus + 5.5 * direction,
                  arrowprops={"arrowstyle": "-|>", "color": wake.LINE, "linewidth": 1.2,
                              "shrinkA": 0, "shrinkB": 0})
    axes.text(focus[0] + 15.0, focus[1] - 4.4, f"focus, {number(speed_m_s)} m/s", ha="right",
              va="top", fontsize=9)
    reach = 40.0
    a = np.radians(angle_deg)
    place = focus + reach * np.array([-np.cos(a), np.sin(a)])
    axes.text(place[0] + 4.0, place[1] + 2.0, f"Mach line, {number(angle_deg, 3)}°\n"
              "sin θ = c_R / v", fontsize=9, ha="left", va="bottom", linespacing=1.4)
    axes.annotate("echo from the rigid\nbase, 20 mm deep", (1.0, 13.0), (-60.0, 27.0), fontsize=9,
                  va="center", linespacing=1.3, arrowprops={"arrowstyle": "-", "linewidth": 0.7,
                                                            "color": wake.LINE, "shrinkA": 4})


def scale_bar(axes: Axes) -> None:
    x, y = SHOWN_mm[0] + 5.0, SHOWN_mm[2] + 5.0
    axes.plot([x, x + 20.0], [y, y], color=wake.LINE, linewidth=2.4, solid_capstyle="butt")
    axes.text(x + 10.0, y + 1.4, "20 mm", ha="center", va="bottom", fontsize=9)


def draw(shot: Snapshot) -> Figure:
    figure = plt.figure(figsize=np.array(SIZE_px) / DPI)
    axes = figure.add_axes([0.078, 0.115, 0.792, 0.865])
    smooth = matplotlib.colormaps[style.DIVERGING].resampled(320)
    image = axes.imshow(shot.u_um.T, origin="lower", cmap=smooth, vmin=-SCALE_end_um,
                        vmax=SCALE_end_um, interpolation="bicubic", interpolation_stage="data",
                        extent=wake.extent(shot.x_mm, shot.y_mm))
    wake.draw_theory(axes, shot.case, shot.t_s)
    axes.set(xlim=SHOWN_mm[:2], ylim=SHOWN_mm[2:], xlabel="x (mm)", ylabel="y (mm)")
    axes.grid(False)
    for spine in axes.spines.values():
        spine.set_visible(True)
    speed = 1e-3 * np.hypot(*np.diff(wake.focus_at(shot.case, shot.t_s)[2][-2:], axis=0)[0]) / (
        shot.case.over_time["time"][1] - shot.case.over_time["time"][0])
    arrow_and_words(axes, shot, speed, shot.case.value("mach_angle_theory_deg"))
    scale_bar(axes)
    bar = figure.colorbar(image, cax=figure.add_axes([0.892, 0.1195, 0.018, 0.84]), extend="both")
    bar.set_label(f"$u_z$ (µm), positive into the skin; "
                  f"clipped, the focus reaches {number(shot.u_um.max(), 2)}",
                  fontsize=9)
    bar.outline.set_linewidth(0.5)
    bar.ax.grid(False)
    return figure


def draw_folder(folder: Path, picture: Path) -> None:
    """Draws the first complete case with a snapshot in an output folder of jobs/mach-cone.toml."""
    shots = [s for c in load(folder).cases if c.is_complete and (s := snapshot(c))]
    if not shots:
        raise ValueError(f"{folder} contains no complete case with a snapshot")
    figure_style.reset()
    figure = draw(shots[0])
    figure.savefig(picture, dpi=DPI, facecolor="white")
    plt.close(figure)
