# SPDX-License-Identifier: BSD-3-Clause
"""What was asked, what the device plays and what the skin does, of jobs/device-list.toml."""
from pathlib import Path

import matplotlib.pyplot as plt

from shearwake import Sweep, figure_style
from shearwake.report.style import PALETTE


def draw_folder(out: Path, picture: Path) -> None:
    figure_style.reset()
    played = next(case for case in Sweep(out).every_case if not case.is_reference)
    figure, axes = plt.subplots(1, 3, figsize=(8.0, 2.9), layout="constrained")
    for name, case, colour, dots, steps in (("asked", played.reference, PALETTE[0], "-", "default"), ("played", played, PALETTE[1], ".", "steps-post")):
        assert case is not None
        t_ms, x_mm, y_mm = (1e3 * case.over_time[key] for key in ("time", "focus_x", "focus_y"))
        axes[0].plot(x_mm, y_mm, dots, color=colour, label=name)
        axes[1].plot(t_ms, x_mm, color=colour, drawstyle=steps)
        axes[2].plot(t_ms, 1e6 * case.traces.values[0], color=colour)
    for each, title, x, y in zip(axes, ("focus", "focus over time", "skin at x = 10 mm"), ("x (mm)", "t (ms)", "t (ms)"), ("y (mm)", "x (mm)", "u_z (µm)")):
        each.set(xlabel=x, ylabel=y)
        each.set_title(title, loc="left")
    axes[0].set_aspect("equal")
    axes[0].legend(loc="center")
    figure.savefig(picture, dpi=200, facecolor="white")
    plt.close(figure)
