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
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt
import numpy as np

sys.path.insert(0, str(Path(__file__).resolve().parent))
import lateral_modulation

ROOT = Path(__file__).resolve().parent.parent
JND_dB = 2.3
SKIN = ("medium.layer[1].c_s_m_s", "medium.layer[1].viscosity_Pa_s", "medium.layer[1].thickness_mm")
NOMINAL_c_s_m_s, NOMINAL_PEAK_Pa = 5.0, 125.0
RAYLEIGH_OVER_SHEAR = 0.955  # speeds on an incompressible half-space
LARGEST_SHIFT = 0.1  # of the interval, by which a median may depend on the spacing of the axis
AM_FREQUENCY, DRAW_FREQUENCY = "load.modulation.am_frequency_Hz", "load.modulation.draw_frequency_Hz"
Row = dict[str, Any]


def number(text: str) -> Any:
    try:
        return float(text)
    except ValueError:
        return text or math.nan


def read_skins(path: Path) -> list[list[Row]]:
    """The rows of a table, one list per sampled skin."""
    found: dict[tuple[str, ...], list[Row]] = {}
    with path.open(encoding="utf-8", newline="") as file:
        for row in csv.DictReader(file):
            if row["status"] != "complete":
                raise SystemExit(f"{path}: case {row['id']} is {row['status']}")
            skin = tuple(row.get(key, "") for key in SKIN)
            found.setdefault(skin, []).append({k: v if k == "id" else number(v) for k, v in row.items()})
    return list(found.values())


def column(rows: list[Row], name: str) -> np.ndarray:
    return np.array([row[name] for row in rows], dtype=float)


def find_crossing(x: np.ndarray, y: np.ndarray, level: float) -> float:
    """Where y first rises to the level, by linear interpolation; infinite if it does not."""
    order = np.argsort(x)
    x, y = x[order], y[order]
    above = np.flatnonzero(y >= level)
    if not len(above):
        return math.inf
    n = above[0]
    return float(x[n] if n == 0 else x[n - 1] + (x[n] - x[n - 1]) * (level - y[n - 1]) / (y[n] - y[n - 1]))


def find_maximum(x: np.ndarray, y: np.ndarray) -> float:
    """Where y is largest, by a parabola through the largest value and its neighbours; at the ends, the end itself."""
    order = np.argsort(x)
    x, y = x[order], y[order]
    n = int(np.argmax(y))
    if n in (0, len(x) - 1):
        return float(x[n])
    a, b, _ = np.polyfit(x[n - 1:n + 2] - x[n], y[n - 1:n + 2], 2)
    return float(x[n] - b / (2.0 * a)) if a < 0.0 else float(x[n])


def distances(rows: list[Row]) -> np.ndarray:
    return np.ptp(np.array([ast.literal_eval(row["load.modulation.foci_mm"]) for row in rows]), axis=1)[:, 0]


def speeds(rows: list[Row], length_m: float) -> np.ndarray:
    return length_m * column(rows, DRAW_FREQUENCY)


def gap_distance(rows: list[Row]) -> float:
    return find_crossing(distances(rows), column(rows, "felt_gap_dB"), JND_dB)


def gap_ratio(rows: list[Row]) -> float:
    slow, fast = ([r for r in rows if r[AM_FREQUENCY] == f] for f in (20.0, 200.0))
    return gap_distance(fast) / gap_distance(slow)


def strongest_speed_over_wave(rows: list[Row]) -> float:
    wave_m_s = RAYLEIGH_OVER_SHEAR * rows[0].get(SKIN[0], NOMINAL_c_s_m_s)
    return find_maximum(speeds(rows, 0.2), column(rows, "felt_path_dB")) / wave_m_s


def growth_exponent(rows: list[Row]) -> float:
    """Slope of the amplitude relative to the threshold against the revolutions per second, both logarithmic."""
    return float(np.polyfit(np.log10(column(rows, DRAW_FREQUENCY)), column(rows, "felt_path_dB") / 20, 1)[0])


def most_sensitive_frequency(rows: list[Row]) -> float:
    return math.exp(find_maximum(np.log(column(rows, AM_FREQUENCY)), column(rows, "felt_peak_dB")))


def most_sensitive_tested_frequency(rows: list[Row]) -> float:
    return float(column(rows, AM_FREQUENCY)[np.argmax(column(rows, "felt_peak_dB"))])


def threshold_force_mN(rows: list[Row]) -> float:
    """The force of the job is 1 mN."""
    return float(10 ** (-next(r["felt_peak_dB"] for r in rows if r[AM_FREQUENCY] == 200.0) / 20))


def half_width(rows: list[Row]) -> float:
    return width(rows) / 2


def width(rows: list[Row]) -> float:
    return float(rows[0]["felt_width_mm"])


def select(rows: list[Row], kind: str) -> list[Row]:
    return sorted((r for r in rows if r["load.modulation.kind"] == kind), key=lambda r: r[AM_FREQUENCY])


def minus_am(rows: list[Row], kind: str, name: str = "felt_peak_dB") -> np.ndarray:
    return column(select(rows, kind), name) - column(select(rows, "AM"), name)


def lm_minus_am_least(rows: list[Row]) -> float:
    return float(np.min(minus_am(rows, "STM")))


def slow_lm(rows: list[Row]) -> Row:
    return select(rows, "LM")[0]


def level_of_slow_lm(rows: list[Row]) -> float:
    """With a force of 27 mN, whose peak at a FWHM of 10.2 mm is 4 ln 2 / pi times the force over FWHM^2."""
    row = slow_lm(rows)
    peak_Pa = 4 * math.log(2) / math.pi * 27e-3 / 10.2e-3**2
    return float(row["felt_peak_dB"] + 20 * math.log10(peak_Pa / row.get("load.peak_Pa", NOMINAL_PEAK_Pa)))


def band_of_slow_lm(rows: list[Row]) -> float:
    return float(slow_lm(rows)["felt_band_Hz"])


def share_of_sa1_spikes(rows: list[Row]) -> float:
    spikes = {name: column(rows, name).sum() for name in rows[0] if name.endswith("_spikes_1")}
    return float(spikes["SA1_spikes_1"] / sum(spikes.values())) if sum(spikes.values()) else math.nan


def few_points_minus_many(rows: list[Row]) -> float:
    def level(points: int) -> float:
        return next(r["felt_path_dB"] for r in rows if f"circle-{points}-points-5-Hz" in r["load.modulation.path"])
    return level(4) - level(100)


def share_on_path_slow_over_fast(rows: list[Row]) -> float:
    speed, share = speeds(rows, 0.12), column(rows, "felt_on_path_1")
    return float(share[speed <= 4.0].mean() / share[speed > 4.0].mean())


def peak_over_am(rows: list[Row]) -> float:
    return float(np.median(column(rows, "velocity_peak_frequency_Hz") / column(rows, AM_FREQUENCY)))


def corners_gain(rows: list[Row]) -> float:
    """What pauses add to the largest level, relative to the mean along the path. The largest one is at a corner."""
    above = {r["load.modulation.corner_dwell_ms"]: r["felt_peak_dB"] - r["felt_path_dB"] for r in rows}
    return above[50.0] - above[0.0]


@dataclass
class Result:
    """A study, its prediction for each skin, and that for a skin without waves (None: has none)."""
    study: dict[str, Any]
    values: np.ndarray
    springs: float | None
    shift: float | None = None  # of the median with half of the values of the axis, relative to the interval

    def includes(self, value: float | None) -> bool:
        low, high = self.study["reported"]
        return value is not None and bool(low <= value <= high)

    @property
    def met(self) -> bool:
        return self.includes(float(np.median(self.values)))

    @property
    def springs_met(self) -> bool:
        return self.includes(self.springs)

    def share(self) -> tuple[float, float]:
        """Share of the skins in the interval and its standard error, that of (k + 1) / (n + 2), which is never 0."""
        n, k = len(self.values), sum(self.includes(value) for value in self.values)
        p = (k + 1) / (n + 2)
        return k / n, math.sqrt(p * (1 - p) / n)


def halve_axis(rows: list[Row], axis: str) -> list[Row]:
    """The rows with every other value of the axis, from the first one on."""
    kept = list(dict.fromkeys(str(row[axis]) for row in rows))[::2]
    return [row for row in rows if str(row[axis]) in kept]


def evaluate(study: dict[str, Any], skins: list[list[Row]], springs: list[Row] | None) -> Result:
    quantity: Callable[[list[Row]], float] = globals()[study["quantity"]]
    result = Result(study, np.array([quantity(rows) for rows in skins]), quantity(springs) if springs else None)
    if np.any(np.isnan(result.values)):
        raise SystemExit(f"{study['name']}: {np.sum(np.isnan(result.values))} of {len(skins)} skins have no value")
    if "axis" in study:
        coarse = float(np.median([quantity(halve_axis(rows, study["axis"])) for rows in skins]))
        low, high = study["reported"]
        size = high - low if math.isfinite(high - low) else abs(high if math.isfinite(high) else low)
        result.shift = abs(coarse - float(np.median(result.values))) / size
    return result


def read_table(folder: Path, job: str, variant: str = "") -> list[list[Row]]:
    return read_skins(folder / f"{job}{variant}" / "tables" / f"study-{job}.csv")


def summarise(results: list[Result]) -> str:
    numbers, orders = ([r for r in results if r.study["kind"] == kind] for kind in ("number", "order"))
    wrong = [r.study["name"] for r in orders if not r.met]
    return (f"Of {len(numbers)} results with a number, {sum(r.met for r in numbers)} are met by the median of "
            f"{len(results[0].values)} sampled skins, {sum(r.met and r.springs_met for r in numbers)} of these also by a skin without "
            f"waves; of {len(orders)} orders, {sum(r.met for r in orders)} are met, {sum(r.met and r.springs_met for r in orders)} of "
            f"these also by a skin without waves." + (f" Orders that are predicted wrongly: {', '.join(wrong)}." if wrong else ""))


def format_number(value: float) -> str:
    return f"{value:.3g}".replace("inf", "∞")


def format_interval(study: dict[str, Any]) -> str:
    (low, high), unit = study["reported"], f" {study['unit']}" if study["unit"] else ""
    text = f"{low:g} to {high:g}" if math.isfinite(high - low) else f"at least {low:g}" if math.isfinite(low) else f"at most {high:g}"
    return f"{text}{unit}{', our choice' if study['chosen'] == 'us' else ''}"


def format_row(r: Result) -> str:
    study, (share, error) = r.study, r.share()
    unit = f" {study['unit']}" if study["unit"] else ""
    low, median, high = (format_number(float(np.quantile(r.values, q))) for q in (0.1, 0.5, 0.9))
    springs = "none" if r.springs is None else f"{format_number(r.springs)}{unit}, {'' if r.springs_met else 'not '}met"
    return (f"| {study['name']} | {format_interval(study)} | {median} ({low} to {high}){unit} | {100 * share:.0f} ± {100 * error:.0f} % | "
            f"{'met' if r.met else 'not met'} | {springs} |")


def format_details(r: Result) -> str:
    study, authors = r.study, re.match(r".*?\d{4}", r.study["source"])
    axis = "" if r.shift is None else f" Half of the axis: {100 * r.shift:.0f} %."
    why = f" {study['why']}." if "why" in study else ""
    return (f"* **{study['name']}** ([{authors[0] if authors else study['source']}]({study['link']}); `{study['job']}`, "
            f"`{study['quantity']}`): {study['measured']}. Reported: {study['statement']}.{axis}{why}")


def format_table(results: list[Result]) -> str:
    """One short row per result, and the details below."""
    ordered = sorted(results, key=lambda r: (r.met, r.springs_met))
    head = "| result | interval | predicted, median (10 to 90 % of the skins) | skins inside | verdict | springs |"
    return "\n".join([head, "|---" * 6 + "|", *map(format_row, ordered), "", *map(format_details, ordered)])


def sum_over_places(folder: Path, rows: list[Row], kind: str) -> np.ndarray:
    """10 log10 of the sum over places of (a / a_0)^2, minus that of AM."""
    def total_dB(row: Row) -> float:
        with h5py.File(folder / "takahashi-lm" / "cases" / f"{row['id']}.h5") as file:
            return float(10 * np.log10(np.nansum(10 ** (file["sensation/level"][:] / 10))))
    return np.array([total_dB(lm) - total_dB(am) for lm, am in zip(select(rows, kind), select(rows, "AM"))])


def compare_definitions(folder: Path) -> str:
    """LM minus AM with other definitions of the level, against the frequency."""
    skins = read_table(folder, "takahashi-lm")
    vectors = [lateral_modulation.compare([rows[0][key] for key in (*SKIN, "load.peak_Pa")],
                                          {kind: {row[AM_FREQUENCY]: row["felt_peak_dB"] for row in select(rows, kind)}
                                           for kind in ("AM", "STM")}) for rows in skins]
    variants = {
        "circle, largest normal acceleration (the definition)": [minus_am(rows, "STM") for rows in skins],
        "line instead of the circle": [minus_am(rows, "LM") for rows in skins],
        "sum over third octaves": [minus_am(rows, "STM", "felt_peak_sum_dB") for rows in skins],
        "sum over places": [sum_over_places(folder, rows, "STM") for rows in skins],
        "normal and tangential acceleration": vectors,
        "skin without waves": [minus_am(read_table(folder, "takahashi-lm", "-springs")[0], "STM")],
    }
    frequencies = column(select(skins[0], "AM"), AM_FREQUENCY)
    lines = ["| level of LM minus that of AM (dB), median | " + " | ".join(f"{f:g} Hz" for f in frequencies) + " | above 0 dB at all | above 2.3 dB at all |",
             "|---" * (len(frequencies) + 3) + "|"]
    for name, differences in variants.items():
        least = np.min(differences, axis=1)
        shares = " | ".join(f"{100 * np.mean(least >= limit):.0f} %" for limit in (0.0, JND_dB))
        lines.append(f"| {name} | " + " | ".join(f"{value:.1f}" for value in np.median(differences, axis=0)) + f" | {shares} |")
    return "\n".join(lines)


def draw(results: list[Result], path: Path) -> None:
    """The share of the skins that meet each result, and whether a skin without waves does."""
    figure, axes = plt.subplots(figsize=(8.0, 0.34 * len(results) + 1.3), layout="constrained")
    ordered = sorted(results, key=lambda r: (r.study["kind"] == "order", r.met, r.springs_met))
    for n, r in enumerate(reversed(ordered)):
        share, error = r.share()
        colour = "#1b7837" if r.met else "#a02020"
        axes.barh(n, 100 * share, height=0.6, color=colour, alpha=0.8 if r.study["kind"] == "number" else 0.45)
        axes.plot([100 * max(0.0, share - error), 100 * min(1.0, share + error)], [n, n], color="black", linewidth=1.0)
        axes.text(103, n, "none" if r.springs is None else "met" if r.springs_met else "not met", va="center")
    axes.text(103, len(results) - 0.35, "springs", va="bottom", fontweight="bold")
    axes.set_yticks(range(len(results)), [f"{r.study['name']} ({r.study['kind']})" for r in reversed(ordered)])
    axes.set_xlim(0, 118)
    axes.set_xticks(range(0, 101, 20))
    axes.axvline(50, color="grey", linewidth=0.8)
    axes.set_xlabel("skins inside (%), with standard error; green: median inside")
    figure.savefig(path, dpi=110)


def main() -> int:
    folder = Path(sys.argv[1])
    studies = tomllib.loads((ROOT / "jobs/studies/studies.toml").read_text(encoding="utf-8"))["study"]
    results = [evaluate(study, read_table(folder, study["job"]),
                        read_table(folder, study["job"], "-springs")[0] if study.get("springs", True) else None) for study in studies]
    pictures = ROOT / "docs/explanation/user-studies"
    pictures.mkdir(exist_ok=True)
    draw(results, pictures / "verdicts.png")
    text = (ROOT / "jobs/studies/page.txt").read_text(encoding="utf-8").format(
        summary=summarise(results), skins=len(results[0].values), definitions=compare_definitions(folder),
        waves=", ".join(r.study["name"] for r in results if r.met and r.springs is not None and not r.springs_met),
        **{kind: format_table([r for r in results if r.study["kind"] == kind]) for kind in ("number", "order")})
    (ROOT / "docs/explanation/user-studies.md").write_text(text, encoding="utf-8")
    print(summarise(results))
    coarse = [r.study["name"] for r in results if r.shift is not None and r.shift > LARGEST_SHIFT]
    if coarse:
        print(f"not converged; refine the axis: {', '.join(coarse)}", file=sys.stderr)
    return 1 if coarse else 0


if __name__ == "__main__":
    sys.exit(main())
