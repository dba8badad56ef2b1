# SPDX-License-Identifier: BSD-3-Clause
"""Figures of a job with [uncertain]: bands around curves, probabilities, sensitivity indices and scatter plots."""
from __future__ import annotations

import math
from typing import Any

import numpy as np
from matplotlib.axes import Axes

from ...tables import read_sensitivity, read_statistics
from .. import labels, layout, sample, style, warnings_of, words
from ..figure import Figure
from ..load import Selection
from ..validity import CROSSES
from . import fig_heat

COLUMNS = ("eta_period_1", "eta_period_over_reference_1", "focal_rms_um", "focal_rms_over_reference_1")
TITLES = {"first_order": "first order", "total": "total", "mu_star": "µ*", "sigma": "σ"}
PANELS = 4  # largest number of swept values with bars of their own


def drawn_columns(selection: Selection, rows: Any) -> Any:
    """The main columns and those with a threshold, as far as they have values."""
    names = [*COLUMNS, *(c for c in selection.sweep.uncertain["exceedance"] if c not in COLUMNS)]
    return [name for name in names if sample.by_place(selection, rows, name)]


def curves(selection: Selection, found: Any) -> Any:
    """{label: [(x, statistics)]} with one curve per combination of the other swept values. Without a numeric x each
    combination is a point at its number."""
    numeric = bool(selection.x) and layout.is_numeric(selection)
    made: dict[str, list[Any]] = {}
    keys = sample.swept(selection)
    for n, (where, statistics) in enumerate(found.items()):
        if numeric:
            x = float(where[keys.index(selection.x)])
            made.setdefault(sample.label(selection, where, selection.x), []).append((x, statistics))
        else:
            made.setdefault("", []).append((n, statistics))
    return {name: sorted(points, key=lambda p: p[0]) for name, points in made.items()}, numeric


def values(points: Any, name: str, part: Any = "value") -> Any:
    return np.array([statistics[name][part] for _, statistics in points])


def name_x(axes: Axes, selection: Selection, found: Any, numeric: Any) -> None:
    if numeric:
        axes.set_xlabel(labels.axis_label(selection, selection.x))
        return
    texts = [style.plain(sample.label(selection, where) or "all samples") for where in found]
    axes.set_xticks(range(len(texts)), texts, rotation=0 if len(texts) < 3 else 20,
                    ha="center" if len(texts) < 3 else "right")
    axes.set_xlim(-0.6, len(texts) - 0.4)


def draw_curves(axes: Axes, selection: Selection, found: Any, middle: Any, ends: Any, inner: Any = None) -> None:
    """Curves of a statistic with a band between two ends (statistic, part of its row)."""
    made, numeric = curves(selection, found)
    for colour, (name, points) in zip(style.distinct(len(made)), made.items()):
        x = np.array([p[0] for p in points], dtype=float)
        y, low, high = values(points, middle), values(points, *ends[0]), values(points, *ends[1])
        if numeric and len(x) > 1:
            axes.fill_between(x, low, high, color=colour, alpha=0.15, linewidth=0)
            if inner:
                axes.fill_between(x, values(points, *inner[0]), values(points, *inner[1]), color=colour, alpha=0.25,
                                  linewidth=0)
            axes.plot(x, y, color=colour, marker="o", markersize=4, label=name or None)
        else:
            axes.vlines(x, low, high, color=colour, linewidth=2)
            if inner:
                axes.vlines(x, values(points, *inner[0]), values(points, *inner[1]), color=colour, linewidth=6, alpha=0.5)
            axes.plot(x, y, color=colour, marker="o", linestyle="none", label=name or None)
    name_x(axes, selection, found, numeric)
    if 1 < len(made) <= style.DIRECT_LABELS:
        axes.legend()


def small_sample(rows: Any, columns: Any) -> Any:
    """A sentence if the sample is too small for some of the drawn numbers."""
    notes = [row for row in rows if row["column"] in columns and row["note"]]
    return f" Warning for {len(notes)} of the numbers: {notes[0]['note']}." if notes else ""


def bands(selection: Selection, rows: Any) -> Any:
    columns = drawn_columns(selection, rows)
    if not columns:
        return []
    figure, made = style.panels(len(columns), 1, 2.6, 0.3)
    for axes, column in zip(made[:, 0], columns):
        draw_curves(axes, selection, sample.by_place(selection, rows, column), "q50",
                    (("q05", "value"), ("q95", "value")), (("q50", "low_95"), ("q50", "high_95")))
        axes.set_ylabel(fig_heat.measure_label(selection, column))
    return [Figure(figure, "uncertain_bands", "Median and spread over the samples",
                   "Points: median over the samples. Light band or thin line: from the 5 % to the 95 % quantile, which "
                   "contain 90 % of the samples. Dark band or thick line: 95 % bootstrap confidence interval of the "
                   "median." + small_sample([row for row in rows if row["statistic"] in ("q05", "q50", "q95")], columns),
                   "Median and quantiles of the measures over the samples")]


def probabilities(selection: Selection, rows: Any) -> Any:
    wanted = [(c, f"exceeds {v:.9g}") for c, v in selection.sweep.uncertain["exceedance"].items()]
    wanted = [(c, n) for c, n in wanted if any(n in s for s in sample.by_place(selection, rows, c).values())]
    if not wanted:
        return []
    figure, made = style.panels(len(wanted), 1, 2.6, 0.3)
    for axes, (column, name) in zip(made[:, 0], wanted):
        draw_curves(axes, selection, sample.by_place(selection, rows, column), name, ((name, "low_95"), (name, "high_95")))
        axes.set_ylim(-0.03, 1.03)
        axes.set_ylabel("probability")
        axes.set_title(f"{sample.column_words(selection, column)} {name}", loc="left", color="#555555")
    return [Figure(figure, "uncertain_probability", "Probability of exceeding a threshold",
                   "Fraction of the samples whose value exceeds the threshold of [uncertain] exceedance, with its 95 % "
                   "confidence interval (Wilson)." + small_sample([row for row in rows if (row["column"], row["statistic"])
                                                                   in wanted], {c for c, _ in wanted}), "Exceedance probabilities with confidence intervals")]


def indices(selection: Selection) -> Any:
    rows = [row for row in read_sensitivity(selection.sweep.folder, selection.sweep.name) if not math.isnan(row["value"])]
    column = next((c for c in COLUMNS if any(row["column"] == c for row in rows)), None)
    if column is None:
        return []
    rows = [row for row in rows if row["column"] == column]
    kinds = [k for k in TITLES if any(row["index"] == k for row in rows)]
    places = list(dict.fromkeys(sample.place(selection, row) for row in rows))
    shown = layout.evenly(places, PANELS)
    keys = selection.sweep.uncertain["keys"]
    figure, made = style.panels(len(shown), 1, 2.4, 0.4, sharex=True)
    for axes, where in zip(made[:, 0], shown):
        found = {(row["key"], row["index"]): row for row in rows if sample.place(selection, row) == where}
        for n, (kind, colour) in enumerate(zip(kinds, style.distinct(len(kinds)))):
            bars = [found.get((key, kind)) for key in keys]
            x = np.arange(len(keys)) + 0.8 * ((n + 0.5) / len(kinds) - 0.5)
            y = np.array([b["value"] if b else math.nan for b in bars])
            ends = np.array([[b["low_95"], b["high_95"]] if b else [math.nan] * 2 for b in bars])
            axes.bar(x, y, 0.7 / len(kinds), color=colour, label=TITLES[kind])
            axes.vlines(x, ends[:, 0], ends[:, 1], color=style.INK, linewidth=1.2)
        axes.set_xticks(range(len(keys)), [labels.name(selection, key) for key in keys])
        axes.axhline(0.0, color="#666666", linewidth=0.7)
        axes.set_title(sample.label(selection, where) or "all samples", loc="left", color="#555555")
        axes.grid(False, axis="x")
    made[0, 0].legend(ncol=len(kinds))
    is_sobol = "total" in kinds
    text = ("Sobol indices: the share of the variance that a key explains alone (first order), and with all its "
            "interactions (total)." if is_sobol else
            "Morris measures: mean magnitude (µ*) and standard deviation (σ) of the effect of each key over its whole "
            "range. A large σ means interactions or a non-linear effect.")
    notes = [row["note"] for row in rows if row["note"]]
    text += f" Of {sample.column_words(selection, column)}. Lines: 95 % bootstrap confidence intervals."
    text += f" Warning: {notes[0]}." if notes else ""
    if len(shown) < len(places):
        text += f" The figure shows {len(shown)} of {len(places)} swept values; the table lists all."
    return [Figure(figure, "uncertain_indices", "Sensitivity to the uncertain keys", text,
                   "Sensitivity indices as bars with confidence intervals")]


def scatter(selection: Selection) -> Any:
    cases = [c for c in selection.cases if not c.is_reference]
    column = next((c for c in sample.RESULT if any(not math.isnan(case.value(c, math.nan)) for case in cases)), None)
    if column is None:
        return []
    keys = selection.sweep.uncertain["keys"]
    across = min(3, len(keys))
    figure, made = style.panels(len(keys), across, 2.5, 0.4, sharey=True)
    places = list(dict.fromkeys(sample.place(selection, c.settings) for c in cases))
    shown = layout.evenly(places, style.CURVES)
    failed = [c for c in cases if not c.is_complete]
    invalid = [c for c in cases if c.is_complete and not warnings_of.is_valid_value(selection, c, column)]
    for axes, key in zip(made.flat, keys):
        for colour, where in zip(style.distinct(len(shown)), shown):
            some = [c for c in cases if sample.place(selection, c.settings) == where and not math.isnan(c.value(column, math.nan))
                    and c not in invalid]
            if not some:
                continue
            axes.plot([c.settings[key] for c in some], [c.value(column, math.nan) for c in some], ".", color=colour, markersize=4,
                      alpha=0.7, label=sample.label(selection, where) or None, rasterized=True)
        if invalid:
            axes.plot([c.settings[key] for c in invalid], [c.value(column, math.nan) for c in invalid], **CROSSES, label="not valid")
        if failed:
            low = axes.get_ylim()[0]
            axes.plot([c.settings[key] for c in failed], [low] * len(failed), "x", color="#b00020",
                      label="without a result")
        axes.set_xlabel(words.axis_label(key))
    made[0, 0].set_ylabel(fig_heat.measure_label(selection, column))
    if made[0, 0].get_legend_handles_labels()[0]:
        style.legend_strip(figure, made[0, 0].get_legend_handles_labels()[0])
    text = f"{sample.column_words(selection, column).capitalize()} of every sample against each uncertain key."
    if len(shown) < len(places):
        text += f" The figure shows {len(shown)} of {len(places)} swept values."
    if invalid:
        text += f" Grey crosses, not valid: {words.counted(len(invalid), 'sample')}."
    if failed:
        text += (f" Red crosses: the values of the {words.counted(len(failed), 'sample')} without a result; the list of "
                 "missing cases states the reasons.")
    return [Figure(figure, "uncertain_scatter", "Samples against the uncertain keys", text,
                   "Scatter plots of the samples against the uncertain keys")]


def figures(selection: Selection) -> Any:
    if not selection.sweep.uncertain:
        return []
    rows = read_statistics(selection.sweep.folder, selection.sweep.name)
    return [*bands(selection, rows), *probabilities(selection, rows), *indices(selection),
            *scatter(selection)]
