# SPDX-License-Identifier: BSD-3-Clause
"""Figures of `shearwake optimise`: efficiency against strength with its upper bound, envelopes, the energy at the focus and
in the wake over time, and surfaces."""
from __future__ import annotations

from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes

from ...case import Case
from ...keys import axis_label
from .. import style
from ..figure import Figure
from ..load import Selection, mean_square
from ..optima import along_path, by_case, compared, is_study, middle, optima, swept, title_of, words
from ..page import hover
from ..words import number
from . import fig_surface

LEAST = 0.1  # of the largest rms: what the time-averaged surfaces show
CASES = 6  # largest number of optimised cases with panels of their own
KINDS = (("optimum", "optimum"), ("AM-STM", "am"), ("SM-STM", "sm"))
COLOURS = {"unmodulated": style.GREY, **dict(zip((name for name, _ in KINDS), style.PALETTE))}


def panels(count: int, height: float) -> tuple[Any, list[Axes]]:
    """One panel per case in up to two columns, and the figure."""
    figure, made = style.panels(count, min(2, count), height, 0.4, sharex=True, sharey=True)
    return figure, list(made.flat[:count])


def draw_front(selection: Selection, axes: Axes, rows: list[dict[str, Any]]) -> None:
    axes.plot([r["strength_at_least_1"] for r in rows], [r["eta_ceiling_1"] for r in rows], color=style.INK,
              linestyle="--", label="upper bound", marker="_" if len(rows) == 1 else "", markersize=14, clip_on=False)
    for label, name in KINDS:
        points = sorted({(r[f"strength_{name}_1"], r[f"eta_{name}_1"]) for r in rows if r[f"eta_{name}_1"] > 0})
        if points:
            axes.plot(*zip(*points), color=COLOURS[label], marker="o", markersize=4,
                      label={"optimum": "optimum", "am": "best AM-STM"}.get(name, f"best {label} tried"), linestyle="-" if name == "optimum" else "none")
    axes.plot([1.0], [rows[0]["eta_unmodulated_1"]], color=COLOURS["unmodulated"], marker="s", linestyle="none",
              label="unmodulated")
    axes.set_title(title_of(selection, rows[0]), loc="left", color="#555555")


def finish(figure: Any, made: list[Axes], x: str, y: str) -> None:
    for axes in made[-2:]:
        axes.set_xlabel(x)
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in made[::2]:
        axes.set_ylabel(y)
    handles = {text: handle for axes in made for handle, text in zip(*axes.get_legend_handles_labels())}
    style.legend_strip(figure, list(handles.values()))


def front(selection: Selection, table: dict[str, list[dict[str, Any]]]) -> Figure:
    figure, made = panels(len(table), 2.2)
    for axes, rows in zip(made, table.values()):
        draw_front(selection, axes, rows)
    made[0].set_ylim(0.0, 1.08 * max(value for rows in table.values() for r in rows for name, value in r.items()
                                    if name.startswith("eta_") and np.isfinite(value)))  # of all panels
    finish(figure, made, "strength (1)", axis_label(optima(selection).maximised))
    return Figure(figure, "optimise_front", f"The largest {words(optima(selection).maximised)} for a given strength",
                  "The best envelope that was found for each strength, and the best AM-STM and the best of the SM-STM that were "
                  "tried, of at least the same strength. The strength is the rms over the focal disc relative to the load without "
                  "modulation. The dashed line is an upper bound for all envelopes from 0 to 1 that are linear between the knots, "
                  "with the motion of the optimum; it does not apply to SM-STM, which is another motion. "
                  "scripts/verify_certificate.py verifies it.",
                  f"{words(optima(selection).maximised)} against strength for the optimum, its upper bound and common modulations", cases=[])


def envelope(selection: Selection, case: str, strength: float) -> tuple[np.ndarray, list[float]]:
    """Times in ms and values of an optimum, to the end of a period."""
    optimum = optima(selection).optimum(case, strength)
    knots = optima(selection).forms(optimum["forms"])["knots"]
    values = optimum["found"]["values"] + (optimum["found"]["values"][:1] if knots["repeat"] else [])
    return 1e3 * knots["interval_s"] * np.arange(len(values)), values


def envelopes(selection: Selection, table: dict[str, list[dict[str, Any]]]) -> Figure:
    figure, made = panels(len(table), 1.8)
    for axes, (case, rows) in zip(made, table.items()):
        for colour, row in zip(style.distinct(len(rows)), rows):
            strength = row["strength_at_least_1"]
            axes.plot(*envelope(selection, case, strength), color=colour, label=f"strength {strength:g}")
        axes.set_title(title_of(selection, rows[0]), loc="left", color="#555555")
    finish(figure, made, "t (ms)", "force (1)")
    return Figure(figure, "optimise_envelopes", "The best envelopes",
                  "Force of the focus over time, relative to that of the load without modulation. The envelope is linear between "
                  "its knots.", "Envelopes of the optima over time", cases=[])


def draw_energy(made: np.ndarray, case: Case, name: str, unit: float) -> None:
    t, inside, total = (case.over_time[key] for key in ("time", "focal_sum_u2", "sum_u2"))
    outside = (total - inside) / unit
    for axes, values in zip(made, (inside / unit, outside, np.gradient(outside, 1e3 * t))):
        axes.plot(1e3 * t, values, color=COLOURS[name], label=name)


def energy(selection: Selection, table: dict[str, list[dict[str, Any]]]) -> list[Figure]:
    """Energy at the focus and in the wake over time, for the first optimised case."""
    rows = next(iter(table.values()))
    shown = {name: c for name, c in compared(selection, rows, middle(rows)).items() if "focal_sum_u2" in c.over_time}
    if "unmodulated" not in shown or "optimum" not in shown:
        return []
    unit = shown["unmodulated"].over_time["sum_u2"].mean()
    figure, made = plt.subplots(4, 1, figsize=(style.width_in(), 7.6), sharex=True, layout="constrained")
    for name, case in shown.items():
        force = case.over_time["force"] / shown["unmodulated"].over_time["force"].max()
        made[0].plot(1e3 * case.over_time["time"], force, color=COLOURS[name], label=name)
        draw_energy(made[1:], case, name, unit)
    for axes, label in zip(made, ("force (1)", "energy in the disc (1)", "energy elsewhere (1)", "its growth (1/ms)")):
        axes.set_ylabel(label)
    for axes in made[:3]:
        axes.set_ylim(bottom=0.0)
    made[3].axhline(0.0, color="#999999", linewidth=0.8)
    rates = np.abs(np.concatenate([line.get_ydata()[3:-3] for line in made[3].lines[:-1]]))
    made[3].set_ylim(-1.1 * rates.max(), 1.1 * rates.max())  # without the jump of the focus to the start of a path
    made[-1].set_xlabel("t (ms)")
    style.legend_strip(figure, made[0].get_legend_handles_labels()[0])
    return [Figure(figure, "optimise_energy", "Energy at the focus and in the wake",
                   f"Force, sum of u² over the focal disc, and sum of u² over the rest of the measured region, for {title_of(selection, rows[0])} "
                   f"and a strength of at least {number(middle(rows), 3)}. The sums are relative to the mean over the region for the load "
                   "without modulation. The growth of the energy elsewhere is what flows into the wake less what is absorbed and "
                   "leaves the region.", "Force, energy at the focus and energy in the wake over time",
                   cases=[c.id for c in shown.values()])]


def surfaces(selection: Selection, rows: list[dict[str, Any]], place: int, end: float) -> list[Figure]:
    """The surfaces of one strength of an optimised case side by side, on the colour scale of all optimised cases."""
    shots = [(name, c, shot) for name, c in compared(selection, rows, middle(rows)).items() if (shot := fig_surface.snapshot(c))]
    if not shots:
        return []
    limits = fig_surface.window([shot for _, _, shot in shots], end)
    height = 0.35 + 0.5 * (style.width_in() - 1.6) * (limits[3] - limits[2]) / (limits[1] - limits[0])  # of a panel with its title
    figure, made = style.panels(len(shots), 2, height, 0.5, sharex=True, sharey=True)
    for axes, (name, _, shot) in zip(made.flat, shots):
        image, _ = fig_surface.draw(axes, shot, plt.Normalize(-end, end), limits)
        axes.set_title(f"{name}, {shot.t_s * 1e3:.3g} ms", loc="left", color="#555555")
    for axes in made[-1]:
        axes.set_xlabel("x (mm)")
    for axes in made[:, 0]:
        axes.set_ylabel("y (mm)")
    figure.colorbar(image, ax=list(made.flat), label="$u_z$ (µm)")
    name = f"optimise_surfaces_{place}"
    return [Figure(figure, name, f"Surfaces: {title_of(selection, rows[0])}",
                   "Displacement of the surface at the same instant: without modulation, with the best AM-STM and SM-STM, and with "
                   f"the optimum of strength {number(middle(rows), 3)}.",
                   "Snapshots of the surface for the compared modulations", cases=[c.id for _, c, _ in shots])]


def moving_part(maps: list[Any], least_um: float) -> tuple[float, float, float, float]:
    """The rectangle in mm (from x, to x, from y, to y) in which the rms of any map reaches this value."""
    found = [1e3 * nodes[np.flatnonzero((1e6 * np.sqrt(squared) >= least_um).any(axis=1 - axis))]
             for x, y, squared, _ in maps for axis, nodes in enumerate((x, y))]
    along_x, along_y = (np.concatenate(found[axis::2]) for axis in (0, 1))
    return float(along_x.min()), float(along_x.max()), float(along_y.min()), float(along_y.max())


def means(selection: Selection, table: dict[str, list[dict[str, Any]]]) -> list[Figure]:
    """The time-averaged surfaces without modulation and of the optimum, and the rms along the path."""
    shown = []
    for rows in table.values():
        cases = compared(selection, rows, middle(rows))
        pair = [(name, cases[name], m) for name in ("unmodulated", "optimum") if name in cases and (m := mean_square(cases[name]))]
        if len(pair) == 2:
            shown.append((rows, pair))
    if not shown:
        return []
    rms = [1e6 * np.sqrt(m[2]) for _, pair in shown for _, _, m in pair]
    end = max(float(np.nanmax(u)) for u in rms)
    limits = moving_part([m for _, pair in shown for _, _, m in pair], LEAST * end)
    height = 0.35 + 0.5 * (style.width_in() - 1.6) * (limits[3] - limits[2]) / (limits[1] - limits[0])
    figure, made = style.panels(2 * len(shown), 2, height, 0.6, sharex=True, sharey=True)
    for (rows, pair), line in zip(shown, made):
        for axes, (name, case, (x, y, squared, drawn)) in zip(line, pair):
            image = axes.imshow(1e6 * np.sqrt(squared).T, origin="lower", cmap="magma", vmin=0.0, vmax=end,
                                extent=(1e3 * x[0], 1e3 * x[-1], 1e3 * y[0], 1e3 * y[-1]))
            for points in drawn:
                axes.plot(*(1e3 * points).T, color="white", linewidth=0.8, linestyle=(0, (3, 2)))
            along = along_path(case)
            title = f"{title_of(selection, rows[0])}: {name}" if swept(rows[0]) else name
            axes.set_title(title + (f", uniformity {number(along.uniformity, 2)}" if along else ""), loc="left", color="#555555",
                           fontsize=9)
            axes.grid(False)
            axes.set_xlim(limits[:2])
            axes.set_ylim(limits[2:])
            hover.attach(axes, 1e6 * np.sqrt(squared).T, (1e3 * x[0], 1e3 * x[-1]), (1e3 * y[0], 1e3 * y[-1]), "rms of u", "x (mm)",
                         "y (mm)", "µm", title=name)
        line[0].set_ylabel("y (mm)")
    for axes in made[-1]:
        axes.set_xlabel("x (mm)")
    figure.colorbar(image, ax=list(made.flat), label="rms of $u_z$ over time (µm)")
    ids = [case.id for _, pair in shown for _, case, _ in pair]
    found = [Figure(figure, "optimise_mean", "What is drawn: the time-averaged surface", "Root of the mean of u² over complete periods, without "
                    "modulation and with the optimum of strength "
                    f"{number(middle(shown[0][0]), 3)}, on the same colour scale. Dashed line: the path. The uniformity is the smallest "
                    "rms along the path relative to its mean: 1 if the whole path is equally strong, 0 if it has a gap.",
                    "Time-averaged surface without modulation and with the optimum", cases=ids)]
    return found + path_figure(selection, table)


def path_figure(selection: Selection, table: dict[str, list[dict[str, Any]]]) -> list[Figure]:
    figure, made = panels(len(table), 1.9)
    ids = []
    for axes, rows in zip(made, table.values()):
        cases = {"unmodulated": compared(selection, rows, middle(rows)).get("unmodulated")}
        cases |= {f"optimum, strength {number(r['strength_at_least_1'], 3)}": compared(selection, rows, r["strength_at_least_1"]).get("optimum")
                  for r in rows}
        for colour, (name, case) in zip([style.GREY, *style.distinct(len(rows))], cases.items()):
            if case and (found := along_path(case)):
                axes.plot(found.distance_mm, found.rms_um, color=colour, label=name)
                ids.append(case.id)
        axes.set_title(title_of(selection, rows[0]), loc="left", color="#555555")
    if not ids:
        plt.close(figure)
        return []
    made[0].set_ylim(bottom=0.0)  # of all panels
    finish(figure, made, "distance along the path (mm)", "rms of u (µm)")
    return [Figure(figure, "optimise_path", "Strength along the path", "The rms of u over time along the path. Where it is close to zero, the "
                   "drawn shape has a gap.", "Strength along the path without modulation and for each optimum", cases=ids)]


def figures(selection: Selection) -> list[Figure]:
    if not is_study(selection):
        return []
    table = dict(list(by_case(selection).items())[:CASES])
    found = [front(selection, table), *means(selection, table), envelopes(selection, table),
             *energy(selection, table)]
    ends = [fig_surface.scale(shots) for rows in table.values() if (shots := [
        shot for c in compared(selection, rows, middle(rows)).values() if (shot := fig_surface.snapshot(c))])]
    for place, rows in enumerate(table.values(), start=1):
        found += surfaces(selection, rows, place, max(ends, default=0.0))
    return found
