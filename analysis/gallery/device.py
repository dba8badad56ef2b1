# SPDX-License-Identifier: BSD-3-Clause
"""What was asked, what the device plays and what the skin does, of jobs/device-list.toml."""
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

from shearwake import Sweep, figure_style
from shearwake.report.style import PALETTE

SIZE_in, DPI = (8.0, 2.9), 200


def draw_folder(out: Path, picture: Path) -> None:
    figure_style.reset()
    sweep = Sweep(out)
    played = next(case for case in sweep.every_case if not case.is_reference)
    cases = {"asked": played.reference, "played": played}
    figure, (path, moves, skin) = plt.subplots(1, 3, figsize=SIZE_in, layout="constrained")
    for (name, case), colour in zip(cases.items(), PALETTE):
        assert case is not None
        t_ms, x, y = (np.asarray(case.over_time[key]) * scale for key, scale in (("time", 1e3), ("focus_x", 1e3), ("focus_y", 1e3)))
        u_um = 1e6 * case.traces.values[0]
        is_played = name == "played"
        path.plot(x, y, "." if is_played else "-", color=colour, label=name, zorder=2 if is_played else 1)
        moves.step(t_ms, x, color=colour, where="post") if is_played else moves.plot(t_ms, x, color=colour)
        skin.plot(t_ms, u_um, color=colour)
    path.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    path.set_title("focus", loc="left")
    moves.set(xlabel="t (ms)", ylabel="x (mm)")
    moves.set_title("focus over time", loc="left")
    skin.set(xlabel="t (ms)", ylabel="u_z (µm)")
    skin.set_title("skin at x = 10 mm", loc="left")
    path.legend(loc="center")
    figure.savefig(picture, dpi=DPI, facecolor="white")
    plt.close(figure)
