# SPDX-License-Identifier: BSD-3-Clause
"""Figures of `shearwake optimise`: efficiency against strength with its upper bound, envelopes, and surfaces."""
import csv
import json

import matplotlib.pyplot as plt
import numpy as np

import fig_surface
import layout
import style
from figure import Figure

CASES = 4  # largest number of optimised cases with panels of their own
KINDS = (("optimum", "optimum"), ("AM-STM", "am"), ("SM-STM", "sm"))


def folder_of(sweep):
    return sweep.folder / "optimise"


def is_study(sweep):
    return (folder_of(sweep) / "table.csv").is_file()


def read_table(sweep):
    """{id of the optimised case: rows}, with numbers where the cell is one; NaN: empty."""
    found = {}
    with open(folder_of(sweep) / "table.csv", encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            numbers = {name: float(cell) if cell else float("nan") for name, cell in row.items() if name.endswith("_1")}
            found.setdefault(row["case"], []).append({**row, **numbers})
    return found


def title_of(row):
    """The swept values of an optimised case, which are the columns before the strength."""
    names = list(row)
    swept = names[1:names.index("strength_at_least_1")]
    return ", ".join(f"{name.split('.')[-1]} = {row[name]}" for name in swept)


def panels(count, height):
    figure, made = plt.subplots(count, 1, figsize=(style.WIDTH_in, height * count + 0.3), squeeze=False,
                                layout="constrained")
    return figure, made[:, 0]


def draw_front(axes, rows):
    axes.plot([r["strength_at_least_1"] for r in rows], [r["eta_ceiling_1"] for r in rows], color=style.INK,
              linestyle="--", label="upper bound")
    for colour, (label, name) in zip(style.distinct(3), KINDS):
        points = sorted({(r[f"strength_{name}_1"], r[f"eta_{name}_1"]) for r in rows if r[f"eta_{name}_1"] > 0})
        if points:
            axes.plot(*zip(*points), color=colour, marker="o", markersize=4, label=label if name == "optimum" else f"best {label}",
                      linestyle="-" if name == "optimum" else "none")
    axes.plot([1.0], [rows[0]["eta_unmodulated_1"]], color=style.GREY, marker="s", linestyle="none", label="unmodulated")
    axes.set_ylabel("eta_period_1")
    axes.set_ylim(bottom=0.0)
    axes.set_title(title_of(rows[0]), loc="left", color="#555555")


def front(sweep, folder, table):
    figure, made = panels(len(table), 2.8)
    for axes, rows in zip(made, table.values()):
        draw_front(axes, rows)
    made[0].legend()
    made[-1].set_xlabel("strength: rms over the focal disc relative to the unmodulated load")
    style.save(figure, folder / "optimise_front.png")
    return Figure("optimise_front", "The largest efficiency for a given strength",
                  "Efficiency of the best envelope that was found, against its strength, with the best AM-STM and SM-STM of at "
                  "least the same strength. The dashed line is an upper bound for all envelopes on the same path: "
                  "scripts/verify_certificate.py verifies it.",
                  "Efficiency against strength for the optimum, its upper bound and common modulations")


def envelope(path):
    """Times in ms and values of an optimum, to the end of a period."""
    optimum = json.loads(path.read_text(encoding="utf-8"))
    knots = json.loads((path.parent / f"{optimum['case']}.forms.json").read_text(encoding="utf-8"))["knots"]
    values = optimum["found"]["values"] + (optimum["found"]["values"][:1] if knots["repeat"] else [])
    return 1e3 * knots["interval_s"] * np.arange(len(values)), values


def envelopes(sweep, folder, table):
    figure, made = panels(len(table), 2.2)
    for axes, (case, rows) in zip(made, table.items()):
        for colour, row in zip(style.distinct(len(rows)), rows):
            strength = row["strength_at_least_1"]
            axes.plot(*envelope(folder_of(sweep) / f"{case}.strength-{strength:g}.json"), color=colour, label=f"{strength:g}")
        axes.set_ylabel("force")
        axes.set_title(title_of(rows[0]), loc="left", color="#555555")
    made[0].legend(title="strength at least", ncols=min(4, len(rows)))
    made[-1].set_xlabel("t (ms)")
    style.save(figure, folder / "optimise_envelopes.png")
    return Figure("optimise_envelopes", "The best envelopes",
                  "Force of the focus over time, relative to that of the unmodulated load. The envelope is linear between its "
                  "knots.", "Envelopes of the optima over time")


def side_by_side(sweep, folder):
    """The surfaces of one strength of the first optimised case: unmodulated, best AM-STM and SM-STM, optimum."""
    def of(name):
        return [c for c in layout.ordinary(sweep) if c.settings.get("optimise.modulation") == name]
    optima = of("optimum")
    if not optima:
        return []
    last = optima[min(len(optima) - 1, 2)]
    same = {k: v for k, v in last.settings.items() if not k.startswith("optimise.")}
    shown = [next((c for c in of(name) if {k: v for k, v in c.settings.items() if not k.startswith("optimise.")} == same), None)
             for name in ("unmodulated", "AM-STM", "SM-STM")]
    shots = [(c, fig_surface.snapshot(c)) for c in (*shown, last) if c is not None]
    shots = [(c, shot) for c, shot in shots if shot is not None]
    if not shots:
        return []
    end = fig_surface.scale([shot for _, shot in shots])
    limits = fig_surface.window([shot for _, shot in shots], end)
    figure, made = plt.subplots(len(shots), 1, figsize=(style.WIDTH_in, 2.3 * len(shots)), squeeze=False, sharex=True,
                                layout="constrained")
    for axes, (case, shot) in zip(made[:, 0], shots):
        image, _ = fig_surface.draw(axes, shot, plt.Normalize(-end, end), limits)
        axes.set_title(f"{case.settings['optimise.modulation']}, {shot.t_s * 1e3:.3g} ms", loc="left", color="#555555")
        axes.set_ylabel("y (mm)")
    made[-1, 0].set_xlabel("x (mm)")
    figure.colorbar(image, ax=list(made[:, 0]), label="$u_z$ (µm)")
    style.save(figure, folder / "optimise_surfaces.png")
    return [Figure("optimise_surfaces", "Surfaces of the modulations",
                   "Displacement of the surface at the same instant: unmodulated, with the best AM-STM and SM-STM, and with the "
                   f"optimum of strength {last.settings['optimise.strength_at_least']:g}.",
                   "Snapshots of the surface for the compared modulations", cases=[c.id for c, _ in shots])]


def figures(sweep, folder):
    if not is_study(sweep):
        return []
    table = dict(list(read_table(sweep).items())[:CASES])
    return [front(sweep, folder, table), envelopes(sweep, folder, table), *side_by_side(sweep, folder)]
