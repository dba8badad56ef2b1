"""What presses: where the focus is and how strong, over time, for a few cases."""
import matplotlib.pyplot as plt
import numpy as np

import fig_spectrogram
import layout
import style
import wake
from figure import Figure


def is_moving(case):
    return max(np.ptp(case.series["focus_x"]), np.ptp(case.series["focus_y"])) > 0


def draw_place(axes, case):
    """Coordinates that change, while the load lasts; a line along x has one curve."""
    pressed = wake.last_pressed(case) + 1
    time = 1e3 * case.series["time"][:pressed]
    for name, look in (("x", {"color": style.PALETTE[0]}),
                       ("y", {"color": style.PALETTE[1], "linestyle": "--"})):
        place = 1e3 * case.series["focus_" + name][:pressed]
        if np.ptp(place) > 0:
            axes.plot(time, place, linewidth=1.3, label=name, **look)


def figures(sweep, folder):
    cases = [c for c in fig_spectrogram.chosen(sweep) if "force" in c.series]
    if not cases:
        return []
    moving = any(map(is_moving, cases))
    figure, made = plt.subplots(len(cases), 1 + moving, squeeze=False, sharex=True, sharey="col",
                                layout="constrained",
                                figsize=(style.WIDTH_in, 0.9 + 1.25 * len(cases)))
    for row, case in zip(made, cases):
        if moving:
            draw_place(row[0], case)
        row[-1].plot(1e3 * case.series["time"], 1e3 * case.series["force"], color=style.INK,
                     linewidth=1.2)
        row[0].set_title(layout.case_label(sweep, case), loc="left", fontsize=9)
    largest = max(1e3 * c.series["force"].max() for c in cases)
    made[0, -1].set_ylim(-0.04 * largest, 1.08 * largest)
    made[len(cases) // 2, -1].set_ylabel("force (mN)")
    figure.supxlabel("time (ms)", fontsize=9.5)
    if moving:
        lines = {line.get_label(): line for axes in made[:, 0] for line in axes.get_lines()}
        label = "place" if len(lines) > 1 else next(iter(lines))
        made[len(cases) // 2, 0].set_ylabel(f"{label} (mm)")
        if len(lines) > 1:
            made[0, 0].legend(handles=list(lines.values()), loc="upper right", ncol=2,
                              bbox_to_anchor=(1.0, 1.3))
    style.save(figure, folder / "drive.png")
    text = "The force of the whole footprint, averaged over the carrier's cycle"
    if moving:
        text = "The place of the focus, x and y where they change, and t" + text[1:]
    return [Figure("drive", "How the skin is driven", text + ".", "Place and force over time")]
