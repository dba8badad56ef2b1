"""Time-averaged intensity of the surface with the drawn path, where every frame was kept."""
import numpy as np

import fig_surface
import layout
import load
import player
import style
import wake
from figure import Figure
from words import number


REPEATED = 0.05  # of the width: a stretch of path that comes back so near is not looked at again


def stretches(case, width_m):
    """(start, end) of every piece of the path between frames, of each focus; repeats once."""
    path = 1e-3 * wake.focus_at(case, case.series["time"][-1])[2]
    found = {}
    for offset in 1e-3 * wake.offsets_mm(case):
        for a, b in zip(path[:-1] + offset, path[1:] + offset):
            found.setdefault(tuple(np.round(np.array([*a, *b]) / (REPEATED * width_m))), (a, b))
    return found.values()


def along(case, width_m, x_m, y_m):
    """Which samples lie within this width of the path, or of any focus' path, that was drawn."""
    near = np.zeros((len(x_m), len(y_m)), dtype=bool)
    for a, b in stretches(case, width_m):
        step = b - a
        squared = float(step @ step)
        dx, dy = x_m[:, None] - a[0], y_m[None, :] - a[1]
        share = np.clip((dx * step[0] + dy * step[1]) / squared, 0.0, 1.0) if squared else 0.0
        near |= (dx - share * step[0]) ** 2 + (dy - share * step[1]) ** 2 <= width_m**2
    return near


def inside(case, places_m):
    """Without the margin that the measures leave out, too."""
    sponge_m = case.setting("domain", "sponge_m", default=0.0)
    return (places_m >= places_m[0] + sponge_m) & (places_m <= places_m[-1] - sponge_m)


def sharpness(case, x_m, y_m, square):
    """Share of the time-averaged energy within one FWHM of the drawn line; None without a FWHM."""
    fwhm_m = case.setting("load", "fwhm_m", default=None)
    measured = inside(case, x_m)[:, None] & inside(case, y_m)[None, :]
    total = square[measured].sum()
    if not fwhm_m or not total > 0:
        return None
    return float(square[measured & along(case, fwhm_m, x_m, y_m)].sum() / total)


def figures(sweep, folder):
    cases = player.chosen(sweep)
    found = [(c, m) for c in cases if (m := load.mean_square(c))]
    if not found:
        return []
    rms = [1e6 * np.sqrt(square) for _, (_, _, square) in found]
    end = max(r.max() for r in rms)
    if not end > 0:
        return []
    shots = [fig_surface.Snapshot(c, c.series["time"][-1], 1e3 * x, 1e3 * y, r)
             for (c, (x, y, _)), r in zip(found, rms)]
    figure, made, bar_axes = fig_surface.arrange(shots, fig_surface.window(shots, end))
    limits = fig_surface.window(shots, end)
    shares = []
    for axes, shot, (case, (x, y, square)) in zip(made, shots, found):
        dx, dy = np.diff(shot.x_mm[:2])[0] / 2, np.diff(shot.y_mm[:2])[0] / 2
        extent = (shot.x_mm[0] - dx, shot.x_mm[-1] + dx, shot.y_mm[0] - dy, shot.y_mm[-1] + dy)
        image = axes.imshow(shot.u_um.T, origin="lower", cmap="magma", vmin=0.0, vmax=end,
                            extent=extent, interpolation="bicubic", interpolation_stage="data")
        path = wake.focus_at(case, shot.t_s)[2]
        resting = np.ptp(path, axis=0).max() == 0
        for offset in wake.offsets_mm(case):
            axes.plot(*((path[:1] if resting else path) + offset).T, color="white",
                      linewidth=0.8, linestyle=(0, (2, 2)), marker="+" if resting else "")
        axes.set_xlim(*limits[:2])
        axes.set_ylim(*limits[2:])
        axes.set_aspect("equal")
        axes.grid(False)
        share = sharpness(case, x, y, square)
        shares.append(share)
        words = "" if share is None else f" (sharpness {number(share, 2)})"
        axes.set_title(layout.case_label(sweep, case) + words, loc="left", pad=4)
    bar = figure.colorbar(image, cax=bar_axes, orientation="horizontal",
                          label="rms of $u_z$ over time (µm)")
    bar.outline.set_linewidth(0.5)
    bar_axes.grid(False)
    style.save(figure, folder / "intensity.png")
    text = ("Root of the time-averaged intensity, the mean of u² over the settled frames, one "
            "colour scale for all; dashed: the path that was drawn.")
    if any(s is not None for s in shares):
        text += (" Sharpness: the share of the energy, averaged over time, that lies within one "
                 "FWHM of the path, the absorbing margin left out.")
    return [Figure("intensity", "Time-averaged intensity", text,
                   "Time-averaged intensity of the surface seen from above")]
