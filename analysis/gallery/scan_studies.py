# SPDX-License-Identifier: BSD-3-Clause
"""The results of docs/explanation/scans.md: how measures degrade with the scan, how often the intervals of a fit contain the truth,
and the dispersion of a line scan.

Usage: PYTHONPATH=analysis python3 -m gallery.scan_studies degradation | coverage FOLDER [FIRST LAST] | dispersion PICTURE
Prints a Markdown table, or draws the measured dispersion and the secular equation. Needs the program in build/.
"""
import json
import re
import sys
import tempfile
import tomllib
from pathlib import Path
from typing import Callable

import numpy as np

from shearwake import program
from shearwake.laboratory.dispersion import curves, line_coordinates
from shearwake.laboratory.scan import Scan
from shearwake.laboratory.scan_files import read_scan, write_scan

from .secular import secular_speeds

ROOT = Path(__file__).resolve().parents[2]

COLUMNS = ("eta_period_1", "focal_rms_um", "peak_um", "rms_40_400_um")
FULL = "grid_mm = [190.0, 190.0]\nspacing_mm = 2.0\ncenter_mm = [-1.0, -1.0]\n"
LAYER_KEYS = (("thickness_mm", 1e-3), ("density_kg_m3", 1.0), ("c_p_m_s", 1.0), ("c_s_m_s", 1.0))
LINE = "line_mm = [[-29.5, 0.0], [29.5, 0.0]]\nspacing_mm = 1.0\n"


def job_text(name: str, scan: str) -> str:
    """A job of the repository with another scan, without noise and gaps."""
    lines = (ROOT / "jobs" / f"{name}.toml").read_text(encoding="utf-8").splitlines()
    dropped = ("grid_mm", "noise_um", "averages", "missing", "spacing_mm = 4.0", "# Polytec", "# retro")
    text = "\n".join(line for line in lines if not line.startswith(dropped)) + "\n"
    return text.replace("[vibrometer]\n", "[vibrometer]\n" + scan)


def shearwake(*arguments: object, ranks: int = 1) -> str:
    return program.call(list(map(str, arguments)), ranks=ranks).stdout


def simulated(folder: Path, text: str) -> tuple[Path, Path]:
    job = folder / "job.toml"
    job.write_text(text, encoding="utf-8")
    shearwake("run", job, "--out", folder / "run", "-S", "uncertain={}", ranks=2)
    return job, next((folder / "run" / "cases").glob("*.h5"))


def degraded(scan: Scan, spacing_mm: float, noise_dB: float | None, missing: float, rng: np.random.Generator) -> Scan:
    """The points of a coarser lattice, with noise relative to the rms velocity and a share of points without signal."""
    step = spacing_mm * 1e-3
    on = np.ones(len(scan.x_m), dtype=bool)
    for values in (scan.x_m, scan.y_m):
        on &= np.abs(values / step - np.round(values / step)) < 1e-6
    velocity = scan.velocity_m_s[on].copy()
    if noise_dB is not None:
        near = np.hypot(scan.x_m[on], scan.y_m[on]) < 0.032
        velocity += 10.0 ** (-noise_dB / 20.0) * np.sqrt(np.mean(velocity[near] ** 2)) * rng.normal(size=velocity.shape)
    if missing:
        velocity[rng.permutation(len(velocity))[:round(missing * len(velocity))]] = np.nan
    return Scan(scan.time_s, scan.x_m[on], scan.y_m[on], velocity)


def values_in(text: str) -> dict[str, str]:
    return dict(line.split(" = ") for line in text.splitlines() if " = " in line)


def degradation() -> None:
    rng = np.random.default_rng(1)
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        job, case = simulated(folder, job_text("virtual-experiment", FULL))
        scan = read_scan(case)
        expected = values_in(shearwake("evaluate", job, "--out", folder / "again", "-S", "vibrometer={}"))
        rows = [(2, None, 0.0), (4, None, 0.0), (6, None, 0.0), (8, None, 0.0), (2, 20, 0.0), (4, 20, 0.0), (8, 20, 0.0),
                (2, None, 0.1), (4, None, 0.1), (8, None, 0.1), (4, 20, 0.1)]
        print("| spacing (mm) | noise (dB) | missing | " + " | ".join(f"`{c}`" for c in COLUMNS) + " |")
        print("|---" * (3 + len(COLUMNS)) + "|")
        for spacing, noise, missing in rows:
            write_scan(folder / "data.mat", degraded(scan, spacing, noise, missing, rng), "mat")
            out = folder / "measured"
            text = shearwake("measure", folder / "data.mat", "--options", job, "--out", out, "--no-report", "--repetitions", "0")
            found = values_in(text)
            changes = [float(found[c].split()[0]) / float(expected[c].split()[0]) - 1.0 for c in COLUMNS]
            print(f"| {spacing} | {-noise if noise else '-'} | {100 * missing:.0f} % | "
                  + " | ".join(f"{round(100 * change, 1) + 0.0:+.1f} %".replace("+0.0", "0.0") for change in changes) + " |", flush=True)


TRUTH = {"medium.layer[1].c_s_m_s": 3.0, "medium.layer[1].viscosity_Pa_s": 0.5, "load.peak_Pa": 100.0,
         "vibrometer.trigger_delay_ms": 0.0, "vibrometer.offset_x_mm": 0.0}


def smaller(text: str) -> str:
    """A layer of 12 mm under a Gaussian focus for 20 ms, sampled at 8 kHz: computed in a fraction of the time."""
    for found, new in ((re.search("footprint = .*pressure_Pa_m = 3.4 }", text), 'footprint = { shape = "gaussian", fwhm_mm = 8.6 }\npeak_Pa = 100.0'),
                       (re.search("footprint = .*pressure_Pa_m = 3.0 }", text), 'footprint = { shape = "gaussian", fwhm_mm = 8.6 }\npeak_Pa = 80.0'),
                       (re.search('"load.footprint.pressure.*', text),
                        '"load.peak_Pa" = { distribution = "normal", mean = 80.0, sd = 40.0, min = 10.0, max = 400.0 }')):
        text = text.replace(found[0], new) if found else text
    for old, new in (("extent_mm = [192.0, 192.0]", "extent_mm = [80.0, 80.0]"), ("thickness_mm = 25.0", "thickness_mm = 12.0"),
                     ("duration_ms = 30.0", "duration_ms = 20.0"), ("snapshots_ms = [30.0]", "snapshots_ms = [20.0]"),
                     ("settled_after_ms = 15.0", "settled_after_ms = 10.0"), ("sampling_rate_kHz = 20.0", "sampling_rate_kHz = 8.0")):
        if old not in text:
            raise SystemExit(f"the job does not contain {old}")
        text = text.replace(old, new)
    return text


def coverage(folder: str | Path, first: str | int = 0, last: str | int = 100) -> None:
    """Fits with noise of the seeds first to last - 1. The results of each are kept in the folder and not computed again."""
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    if not list((folder / "run" / "cases").glob("*.h5")):
        simulated(folder, smaller(job_text("virtual-experiment", LINE)))
    scan = read_scan(next((folder / "run" / "cases").glob("*.h5")))
    job = folder / "fit.toml"
    job.write_text(smaller(job_text("read-back", LINE)), encoding="utf-8")
    rms = np.sqrt(np.mean(scan.velocity_m_s ** 2))
    for seed in range(int(first), int(last)):
        result = folder / f"seed-{seed}.json"
        if result.exists():
            continue
        rng = np.random.default_rng(seed)
        noisy = scan.velocity_m_s + 0.1 * rms * rng.normal(size=scan.velocity_m_s.shape)
        write_scan(folder / "data.mat", Scan(scan.time_s, scan.x_m, scan.y_m, noisy), "mat")
        shearwake("fit", job, "--data", folder / "data.mat", "--out", folder / "fit", ranks=2)
        (folder / "fit" / "fit.json").replace(result)
    found = [json.loads(path.read_text())["estimates"] for path in folder.glob("seed-*.json")]
    print("| key | true value | inside the interval | rms error / mean standard error | largest error |\n|---|---|---|---|---|")
    for key, value in TRUTH.items():
        values, errors = (np.array([one[key][name] for one in found]) for name in ("value", "standard_error"))
        inside = sum(one[key]["interval_95"][0] <= value <= one[key]["interval_95"][1] for one in found)
        print(f"| `{key}` | {value:g} | {inside} of {len(found)} | {np.sqrt(np.mean((values - value) ** 2)) / np.mean(errors):.2f} | "
              f"{np.max(np.abs(values - value)):.2g} |")


def dispersion(picture: str) -> None:
    """Draws the dispersion of the line of jobs/gel-dispersion.toml on the roots of the secular equation."""
    import matplotlib
    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    with tempfile.TemporaryDirectory() as name:
        text = (ROOT / "jobs" / "gel-dispersion.toml").read_text(encoding="utf-8")
        _, case = simulated(Path(name), text)
        scan = read_scan(case)
    layers = [tuple(layer[key] * unit for key, unit in LAYER_KEYS) for layer in tomllib.loads(text)["medium"]["layer"]]
    frequencies, speeds, _ = curves(line_coordinates(scan.x_m, scan.y_m), scan.velocity_m_s, scan.rate_Hz)
    figure, axes = plt.subplots(figsize=(7.0, 4.2), constrained_layout=True)
    trial = np.geomspace(1.0, 12.0, 400)
    roots = [(f, c) for f in range(60, 701, 2) for c in secular_speeds(2.0 * np.pi * f, layers, trial)]
    axes.plot(*zip(*roots), ".", ms=1.5, color="0.55", label="roots of the secular equation (no viscosity)")
    axes.plot(frequencies, speeds, "o", ms=4, color="C3", label="line scan")
    axes.set(xlabel="frequency (Hz)", ylabel="phase speed (m/s)", xlim=(60, 700), ylim=(1, 10))
    axes.legend(markerscale=2)
    figure.savefig(picture, dpi=140)
    inside = (frequencies >= 100.0) & (frequencies <= 600.0) & np.isfinite(speeds)
    errors = [min(abs(c / root - 1.0) for root in secular_speeds(2.0 * np.pi * f, layers, trial))
              for f, c in zip(frequencies[inside], speeds[inside])]
    print(f"{len(errors)} frequencies from 100 to 600 Hz; largest difference {100.0 * max(errors):.2f} %, "
          f"median {100.0 * np.median(errors):.2f} %")


if __name__ == "__main__":
    what, *arguments = sys.argv[1:]
    studies: dict[str, Callable[..., None]] = {"degradation": degradation, "coverage": coverage, "dispersion": dispersion}
    studies[what](*arguments)
