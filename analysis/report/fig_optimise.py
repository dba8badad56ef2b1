# SPDX-License-Identifier: BSD-3-Clause
"""Figures of `shearwake optimise`: efficiency against strength with its upper bound, envelopes, the energy at the focus and
in the wake over time, and surfaces."""
import matplotlib.pyplot as plt
import numpy as np

import fig_surface
import layout
import style
from figure import Figure
from package import Optima
from words import number

CASES = 6  # largest number of optimised cases with panels of their own
KINDS = (("optimum", "optimum"), ("AM-STM", "am"), ("SM-STM", "sm"))
COLOURS = {"unmodulated": style.GREY, **dict(zip((name for name, _ in KINDS), style.PALETTE))}


def optima(sweep):
    return Optima(sweep.folder)


def is_study(sweep):
    return optima(sweep).exists


def read_table(sweep):
    """{id of the optimised case: rows}."""
    found = {}
    for row in optima(sweep).rows:
        found.setdefault(row["case"], []).append(row)
    return found


def title_of(row):
    """The swept values of an optimised case, which are the columns before the strength."""
    names = list(row)
    return ", ".join(row[name] for name in names[1:names.index("strength_at_least_1")]) or "the case of the job"


def panels(count, height, **more):
    """One panel per case in up to two columns, and the figure."""
    columns = min(2, count)
    rows = -(-count // columns)
    figure, made = plt.subplots(rows, columns, figsize=(style.WIDTH_in, height * rows + 0.4), squeeze=False, sharex=True,
                                sharey=True, layout="constrained", **more)
    for axes in made.flat[count:]:
        axes.set_visible(False)
    return figure, list(made.flat[:count])


def draw_front(axes, rows):
    axes.plot([r["strength_at_least_1"] for r in rows], [r["eta_ceiling_1"] for r in rows], color=style.INK,
              linestyle="--", label="upper bound")
    for label, name in KINDS:
        points = sorted({(r[f"strength_{name}_1"], r[f"eta_{name}_1"]) for r in rows if r[f"eta_{name}_1"] > 0})
        if points:
            axes.plot(*zip(*points), color=COLOURS[label], marker="o", markersize=4,
                      label=label if name == "optimum" else f"best {label}", linestyle="-" if name == "optimum" else "none")
    axes.plot([1.0], [rows[0]["eta_unmodulated_1"]], color=COLOURS["unmodulated"], marker="s", linestyle="none",
              label="unmodulated")
    axes.set_title(title_of(rows[0]), loc="left", color="#555555")


def finish(figure, made, x, y):
    for axes in made[-2:]:
        axes.set_xlabel(x)
        axes.xaxis.set_tick_params(labelbottom=True)
    for axes in made[::2]:
        axes.set_ylabel(y)
    handles = {text: handle for axes in made for handle, text in zip(*axes.get_legend_handles_labels())}
    style.legend_strip(figure, list(handles.values()))


def front(sweep, folder, table):
    figure, made = panels(len(table), 2.2)
    for axes, rows in zip(made, table.values()):
        draw_front(axes, rows)
    made[0].set_ylim(bottom=0.0)  # of all panels
    finish(figure, made, "strength (1)", optima(sweep).maximised)
    style.save(figure, folder / "optimise_front.png")
    return Figure("optimise_front", f"The largest {optima(sweep).maximised} for a given strength",
                  "The best envelope that was found for each strength, with the best AM-STM and SM-STM of at least the same "
                  "strength. The strength is the rms over the focal disc relative to the load without modulation. The dashed line "
                  "is an upper bound for all envelopes on the same path: scripts/verify_certificate.py verifies it.",
                  f"{optima(sweep).maximised} against strength for the optimum, its upper bound and common modulations", cases=[])


def envelope(sweep, case, strength):
    """Times in ms and values of an optimum, to the end of a period."""
    optimum = optima(sweep).optimum(case, strength)
    knots = optima(sweep).forms(optimum["forms"])["knots"]
    values = optimum["found"]["values"] + (optimum["found"]["values"][:1] if knots["repeat"] else [])
    return 1e3 * knots["interval_s"] * np.arange(len(values)), values


def envelopes(sweep, folder, table):
    figure, made = panels(len(table), 1.8)
    for axes, (case, rows) in zip(made, table.items()):
        for colour, row in zip(style.distinct(len(rows)), rows):
            strength = row["strength_at_least_1"]
            axes.plot(*envelope(sweep, case, strength), color=colour, label=f"strength {strength:g}")
        axes.set_title(title_of(rows[0]), loc="left", color="#555555")
    finish(figure, made, "t (ms)", "force (1)")
    style.save(figure, folder / "optimise_envelopes.png")
    return Figure("optimise_envelopes", "The best envelopes",
                  "Force of the focus over time, relative to that of the load without modulation. The envelope is linear between "
                  "its knots.", "Envelopes of the optima over time", cases=[])


def compared(sweep, rows, strength):
    """{modulation: case} of one optimised case and strength, unmodulated first. A case that several strengths share has
    the settings of the first one."""
    names = list(rows[0])
    swept = names[1:names.index("strength_at_least_1")]
    ordinary = [c for c in layout.ordinary(sweep)
                if all(str(c.settings.get(key)) == rows[0][key] or c.settings.get(key) == rows[0][key] for key in swept)]
    found = {}
    for name in ("unmodulated", "AM-STM", "SM-STM", "optimum"):
        of = [c for c in ordinary if c.settings.get("optimise.modulation") == name]
        exact = [c for c in of if c.settings.get("optimise.strength_at_least") == strength]
        if exact or (of and name != "optimum"):
            found[name] = (exact or of)[0]
    return found


def middle(rows):
    """The strength that is shown where only one is."""
    return rows[(len(rows) - 1) * 2 // 3]["strength_at_least_1"]


def draw_energy(made, case, name, unit):
    t, inside, total = (case.series[key] for key in ("time", "focal_sum_u2", "sum_u2"))
    for axes, values in zip(made, (inside, total - inside)):
        axes.plot(1e3 * t, values / unit, color=COLOURS[name], label=name)


def energy(sweep, folder, table):
    """Energy at the focus and in the wake over time, for the first optimised case."""
    rows = next(iter(table.values()))
    shown = {name: c for name, c in compared(sweep, rows, middle(rows)).items() if "focal_sum_u2" in c.series}
    if "unmodulated" not in shown or "optimum" not in shown:
        return []
    unit = shown["unmodulated"].series["sum_u2"].mean()
    figure, made = plt.subplots(3, 1, figsize=(style.WIDTH_in, 6.0), sharex=True, layout="constrained")
    for name, case in shown.items():
        force = case.series["force"] / shown["unmodulated"].series["force"].max()
        made[0].plot(1e3 * case.series["time"], force, color=COLOURS[name], label=name)
        draw_energy(made[1:], case, name, unit)
    for axes, label in zip(made, ("force (1)", "energy in the disc (1)", "energy elsewhere (1)")):
        axes.set_ylabel(label)
        axes.set_ylim(bottom=0.0)
    made[-1].set_xlabel("t (ms)")
    style.legend_strip(figure, made[0].get_legend_handles_labels()[0])
    style.save(figure, folder / "optimise_energy.png")
    return [Figure("optimise_energy", "Energy at the focus and in the wake",
                   f"Force, sum of u² over the focal disc, and sum of u² over the rest of the measured region, for {title_of(rows[0])} "
                   f"and a strength of at least {number(middle(rows), 3)}. The sums are relative to the mean over the region for the load "
                   "without modulation.", "Force, energy at the focus and energy in the wake over time",
                   cases=[c.id for c in shown.values()])]


def surfaces(sweep, folder, rows, place):
    """The surfaces of one strength of an optimised case side by side."""
    shots = [(name, c, fig_surface.snapshot(c)) for name, c in compared(sweep, rows, middle(rows)).items()]
    shots = [(name, c, shot) for name, c, shot in shots if shot is not None]
    if not shots:
        return []
    end = fig_surface.scale([shot for _, _, shot in shots])
    limits = fig_surface.window([shot for _, _, shot in shots], end)
    figure, made = plt.subplots(-(-len(shots) // 2), 2, figsize=(style.WIDTH_in, 2.1 * -(-len(shots) // 2) + 0.4), squeeze=False,
                                sharex=True, sharey=True, layout="constrained")
    for axes in made.flat[len(shots):]:
        axes.set_visible(False)
    for axes, (name, _, shot) in zip(made.flat, shots):
        image, _ = fig_surface.draw(axes, shot, plt.Normalize(-end, end), limits)
        axes.set_title(f"{name}, {shot.t_s * 1e3:.3g} ms", loc="left", color="#555555")
    for axes in made[-1]:
        axes.set_xlabel("x (mm)")
    for axes in made[:, 0]:
        axes.set_ylabel("y (mm)")
    figure.colorbar(image, ax=list(made.flat), label="$u_z$ (µm)")
    name = f"optimise_surfaces_{place}"
    style.save(figure, folder / f"{name}.png")
    return [Figure(name, f"Surfaces: {title_of(rows[0])}",
                   "Displacement of the surface at the same instant: without modulation, with the best AM-STM and SM-STM, and with "
                   f"the optimum of strength {number(middle(rows), 3)}.",
                   "Snapshots of the surface for the compared modulations", cases=[c.id for _, c, _ in shots])]


def figures(sweep, folder):
    if not is_study(sweep):
        return []
    table = dict(list(read_table(sweep).items())[:CASES])
    found = [front(sweep, folder, table), envelopes(sweep, folder, table), *energy(sweep, folder, table)]
    for place, rows in enumerate(table.values(), start=1):
        found += surfaces(sweep, folder, rows, place)
    return found
