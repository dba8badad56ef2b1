# SPDX-License-Identifier: BSD-3-Clause
"""Compares the tables of jobs/studies with what the studies report, and writes docs/explanation/user-studies.md.

Usage: user_studies.py FOLDER, the folder with one output folder per job. scripts/user-studies calls it.
"""
from __future__ import annotations

import ast
import csv
import math
import re
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

ROOT = Path(__file__).resolve().parent.parent
JND_dB = 2.3
UNCERTAIN = ("load.peak_Pa", "medium.layer[1].c_s_m_s", "medium.layer[1].viscosity_Pa_s", "medium.layer[1].thickness_mm")
VERDICTS = ("outside", "same order", "inside")
Row = dict[str, Any]


def number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text or math.nan


def samples(path: Path) -> list[list[Row]]:
    """The rows of a table, one list per sampled skin and device."""
    found: dict[tuple[str, ...], list[Row]] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["status"] != "complete":
                raise SystemExit(f"{path}: case {row['id']} is {row['status']}")
            found.setdefault(tuple(row[key] for key in UNCERTAIN), []).append({k: number(v) for k, v in row.items()})
    return list(found.values())


def column(rows: list[Row], name: str) -> np.ndarray:
    return np.array([row[name] for row in rows], dtype=float)


def crossing(x: np.ndarray, y: np.ndarray, level: float) -> float:
    """Where y first rises to the level, by linear interpolation; infinite if it does not."""
    order = np.argsort(x)
    x, y = x[order], y[order]
    above = np.flatnonzero(y >= level)
    if not len(above):
        return math.inf
    n = above[0]
    return float(x[n] if n == 0 else x[n - 1] + (x[n] - x[n - 1]) * (level - y[n - 1]) / (y[n] - y[n - 1]))


def distances(rows: list[Row]) -> np.ndarray:
    return np.ptp(np.array([ast.literal_eval(row["load.modulation.foci_mm"]) for row in rows]), axis=1)[:, 0]


def speeds(rows: list[Row], length_m: float) -> np.ndarray:
    return length_m * column(rows, "load.modulation.draw_frequency_Hz")


def gap_distance(rows: list[Row]) -> float:
    return crossing(distances(rows), column(rows, "felt_gap_dB"), JND_dB)


def gap_ratio(rows: list[Row]) -> float:
    slow, fast = ([r for r in rows if r["load.modulation.am_frequency_Hz"] == f] for f in (20.0, 200.0))
    return gap_distance(fast) / gap_distance(slow)


def strongest_speed(rows: list[Row]) -> float:
    return float(speeds(rows, 0.2)[np.argmax(column(rows, "felt_path_dB"))])


def most_sensitive_frequency(rows: list[Row]) -> float:
    return float(column(rows, "load.modulation.am_frequency_Hz")[np.argmax(column(rows, "felt_peak_dB"))])


def small_focus_minus_large(rows: list[Row]) -> float:
    """At the same force: the peak of the pressure grows with the square of the ratio of the sizes."""
    def level(fwhm_mm: float) -> float:
        return float(np.mean([r["felt_peak_dB"] for r in rows if r["load.footprint.fwhm_mm"] == fwhm_mm]))
    return level(2.46) - level(4.3) + 40 * math.log10(4.3 / 2.46)


def correlation_with_speed(rows: list[Row]) -> float:
    """Between the amplitude relative to the threshold, averaged over the path in dB, and the revolutions per second."""
    return float(np.corrcoef(column(rows, "load.modulation.draw_frequency_Hz"), 10**(column(rows, "felt_path_dB") / 20))[0, 1])


def few_points_minus_many(rows: list[Row]) -> float:
    def level(points: int) -> float:
        return next(r["felt_path_dB"] for r in rows if f"circle-{points}-points-5-Hz" in r["load.modulation.path"])
    return level(4) - level(100)


def share_on_path_slow_over_fast(rows: list[Row]) -> float:
    speed, share = speeds(rows, 0.12), column(rows, "felt_on_path_1")
    return float(share[speed <= 4.0].mean() / share[speed > 4.0].mean())


def of_kind(rows: list[Row], kind: str) -> list[Row]:
    return [r for r in rows if r["load.modulation.kind"] == kind]


def lm_minus_am_least(rows: list[Row]) -> float:
    return float(np.min(column(of_kind(rows, "LM"), "felt_peak_dB") - column(of_kind(rows, "AM"), "felt_peak_dB")))


def band_of_slow_lm(rows: list[Row]) -> float:
    return next(r["felt_band_Hz"] for r in of_kind(rows, "LM") if r["load.modulation.lm_frequency_Hz"] == 10.0)


def share_of_sa1_spikes(rows: list[Row]) -> float:
    spikes = {name: column(rows, name).sum() for name in rows[0] if name.endswith("_spikes_1")}
    return float(spikes["SA1_spikes_1"] / sum(spikes.values())) if sum(spikes.values()) else math.nan


def half_width(rows: list[Row]) -> float:
    return rows[0]["felt_width_mm"] / 2


def width(rows: list[Row]) -> float:
    return rows[0]["felt_width_mm"]


def peak_over_am(rows: list[Row]) -> float:
    return float(np.median(column(rows, "velocity_peak_frequency_Hz") / column(rows, "load.modulation.am_frequency_Hz")))


def corners_gain(rows: list[Row]) -> float:
    """What pauses add to the largest level, relative to the mean along the path. The largest one is at a corner."""
    above = {r["load.modulation.corner_dwell_ms"]: r["felt_peak_dB"] - r["felt_path_dB"] for r in rows}
    return above[50.0] - above[0.0]


def verdict(study: dict[str, Any], values: np.ndarray) -> str:
    low, high = study["reported"]
    median = float(np.median(values))
    if low <= median <= high:
        return "inside"
    factor = study.get("factor")
    if values.min() <= high and values.max() >= low:
        return "same order"
    if factor and low / factor <= median <= high * factor:
        return "same order"
    if not factor and study["unit"] == "dB" and median > 0.0:
        return "same order"
    return "outside"


def text_of(value: float) -> str:
    return f"{value:.3g}"


def reported(study: dict[str, Any]) -> str:
    low, high = study["reported"]
    return f"{study['statement']} [{low:g} to {high:g}{' ' if study['unit'] else ''}{study['unit']}]"


def interval(study: dict[str, Any], values: np.ndarray) -> str:
    unit = f" {study['unit']}" if study["unit"] else ""
    return f"{text_of(float(np.median(values)))} ({text_of(values.min())} to {text_of(values.max())}){unit}"


def draw(results: list[tuple[dict[str, Any], np.ndarray, str]], path: Path) -> None:
    """Each prediction relative to the centre of the reported interval, in widths of this interval."""
    colours = {"inside": "#1b7837", "same order": "#b8860b", "outside": "#a02020"}
    figure, axes = plt.subplots(figsize=(8.0, 0.36 * len(results) + 1.2), layout="constrained")
    axes.axvspan(-1.0, 1.0, color="#dddddd", label="reported interval")
    limit = 6.0
    for n, (study, values, result) in enumerate(reversed(results)):
        low, high = study["reported"]
        place = (values - 0.5 * (low + high)) / (0.5 * (high - low))
        shown = np.clip([place.min(), float(np.median(place)), place.max()], -limit, limit)
        axes.plot(shown[[0, 2]], [n, n], color=colours[result], linewidth=2.0)
        beyond = abs(float(np.median(place))) > limit
        axes.plot(shown[1], n, marker=(">" if shown[1] > 0 else "<") if beyond else "o", color=colours[result])
    axes.set_yticks(range(len(results)), [f"{study['name']}: {result}" for study, _, result in reversed(results)])
    axes.set_xlim(-1.05 * limit, 1.05 * limit)
    axes.set_xlabel("prediction, in half widths of the reported interval (arrows: farther)")
    figure.savefig(path, dpi=110)


def main() -> int:
    folder = Path(sys.argv[1])
    studies = tomllib.loads((ROOT / "jobs/studies/studies.toml").read_text(encoding="utf-8"))["study"]
    results = []
    rival = []
    for study in studies:
        tables = samples(next((folder / study["job"] / "tables").glob(f"study-{study['job']}.csv")))
        quantity: Callable[[list[Row]], float] = globals()[study["quantity"]]
        values = np.array([quantity(rows) for rows in tables])
        if not np.all(np.isfinite(values)):
            raise SystemExit(f"{study['name']}: {np.sum(~np.isfinite(values))} of {len(values)} samples have no value")
        results.append((study, values, verdict(study, values)))
        if "felt_peak_sum_dB" in tables[0][0]:
            rival += [r["felt_peak_sum_dB"] - r["felt_peak_dB"] for rows in tables for r in rows]
    results.sort(key=lambda result: VERDICTS.index(result[2]))
    counts = {v: sum(result == v for _, _, result in results) for v in VERDICTS}
    pictures = ROOT / "docs/explanation/user-studies"
    pictures.mkdir(exist_ok=True)
    draw(results, pictures / "verdicts.png")
    page = ROOT / "docs/explanation/user-studies.md"
    head, tail = (ROOT / "jobs/studies/page.txt").read_text(encoding="utf-8").split("TABLE\n")
    why = dict(line.removeprefix("* ").split(": ", 1) for line in tail.splitlines() if line.startswith("* "))
    rows = ["| study | measured | reported [interval] | predicted, median (range) | verdict | why |", "|---|---|---|---|---|---|"]
    for study, values, result in results:
        authors = re.match(r".*?\d{4}", study["source"])
        rows.append(f"| [{study['name']}]({study['link']}), {authors[0] if authors else study['source']} (job `{study['job']}`, "
                    f"`{study['quantity']}`) | {study['measured']} | {reported(study)} | "
                    f"{interval(study, values)} | {result} | {why.get(study['name'], '')} |")
    rest = "\n".join(line for line in tail.splitlines() if not line.startswith("* "))
    text = head.format(total=len(results), inside=counts["inside"], same=counts["same order"], outside=counts["outside"]) + "\n".join(rows) + "\n" + rest.format(
                           rival=text_of(float(np.median(rival))), rival_most=text_of(float(np.max(rival)))) + "\n"
    page.write_text(text, encoding="utf-8")
    print(f"{page}: {counts['inside']} inside, {counts['same order']} in the same order, {counts['outside']} outside")
    return 0


if __name__ == "__main__":
    sys.exit(main())
