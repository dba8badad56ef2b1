# SPDX-License-Identifier: BSD-3-Clause
"""Draws the residuals, the correlations and, for line scans, the dispersion curves of a fit.

Usage: python3 -m shearwake.laboratory.fit_figures FOLDER
FOLDER contains fit.json and fit.h5 of `shearwake fit`. Writes residuals.csv, residuals.png, correlations.png and, for a line
scan, dispersion.csv and dispersion.png.
"""
import json
import sys
from collections.abc import Iterable
from pathlib import Path

import h5py
import numpy as np
from matplotlib import pyplot as plt

from .. import figure_style
from .dispersion import curves, line_coordinates

USAGE, ENVIRONMENT = 2, 6


def table(path: Path, header: str, columns: Iterable) -> None:
    rows = [",".join(f"{value:.9g}" for value in row) for row in zip(*columns)]
    path.write_text("\n".join([header, *rows]) + "\n", encoding="utf-8")


def draw_residuals(folder: Path, fit: dict, is_line: bool) -> None:
    x, y, rms, weight = (fit[name] for name in ("x", "y", "residual_rms", "weight"))
    table(folder / "residuals.csv", "x_mm,y_mm,residual_um_s,weight", (1e3 * x, 1e3 * y, 1e6 * rms, weight))
    figure, axes = plt.subplots(figsize=(5.6, 4.2), constrained_layout=True)
    if is_line:
        s = 1e3 * line_coordinates(x, y)
        axes.plot(s, 1e6 * rms, "o", ms=4)
        axes.plot(s[weight < 0.5], 1e6 * rms[weight < 0.5], "x", ms=9, color="C3", label="outlier")
        axes.set(xlabel="position along the line (mm)", ylabel="residual rms (um/s)", ylim=(0, None))
    else:
        points = axes.scatter(1e3 * x, 1e3 * y, c=1e6 * rms, s=18, cmap="viridis")
        axes.scatter(1e3 * x[weight < 0.5], 1e3 * y[weight < 0.5], marker="x", s=60, color="C3", label="outlier")
        figure.colorbar(points, label="residual rms (um/s)")
        axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal")
    if np.any(weight < 0.5):
        axes.legend()
    figure.savefig(folder / "residuals.png", dpi=140)


def draw_correlations(folder: Path, about: dict) -> None:
    names = list(about["estimates"])
    if len(names) < 2:
        return
    values = np.array(about["correlations"], dtype=float)
    figure, axes = plt.subplots(figsize=(2.6 + 1.1 * len(names), 1.8 + 0.9 * len(names)), constrained_layout=True)
    image = axes.imshow(values, vmin=-1.0, vmax=1.0, cmap="RdBu_r")
    axes.set_xticks(range(len(names)), names, rotation=35, ha="right")
    axes.set_yticks(range(len(names)), names)
    for i, row in enumerate(values):
        for j, value in enumerate(row):
            axes.text(j, i, f"{value:.2f}", ha="center", va="center", color="white" if abs(value) > 0.6 else "black")
    figure.colorbar(image, label="correlation of the estimates")
    figure.savefig(folder / "correlations.png", dpi=140)


def draw_dispersion(folder: Path, fit: dict, noise_m_s: float) -> None:
    s = line_coordinates(fit["x"], fit["y"])
    rate = (len(fit["time"]) - 1) / (fit["time"][-1] - fit["time"][0])
    frequencies, *measured = curves(s, fit["measured"], rate, noise_m_s=noise_m_s)
    _, *model = curves(s, fit["predicted"], rate, noise_m_s=noise_m_s)
    shown = np.isfinite(measured[0]) | np.isfinite(model[0])
    if not np.any(shown):
        raise ValueError("no wave on the line exceeds the noise and is shorter than the line")
    table(folder / "dispersion.csv", "frequency_Hz,speed_m_s,attenuation_1_m,model_speed_m_s,model_attenuation_1_m",
          (frequencies[shown], *(values[shown] for values in (*measured, *model))))
    figure, axes = plt.subplots(1, 2, figsize=(8.4, 3.8), constrained_layout=True)
    for one, data, curve, label in zip(axes, measured, model, ("phase speed (m/s)", "attenuation (1/m)")):
        one.plot(frequencies, curve, "-", lw=2, label="model")
        one.plot(frequencies, data, "o", ms=4, color="C3", label="measured")
        one.set(xlabel="frequency (Hz)", ylabel=label)
        one.set_xlim(0, 1.05 * np.max(frequencies[shown], initial=1.0))
    axes[0].set_ylim(0, None)
    axes[0].legend()
    figure.savefig(folder / "dispersion.png", dpi=140)


def main(folder: Path) -> int:
    try:
        about = json.loads((folder / "fit.json").read_text(encoding="utf-8"))
        with h5py.File(folder / "fit.h5", "r", locking=False) as file:
            fit = {name: file[name][()] for name in ("x", "y", "time", "measured", "predicted", "residual_rms", "weight")}
        figure_style.reset()
        draw_residuals(folder, fit, about["is_line"])
        draw_correlations(folder, about)
        if about["is_line"]:
            try:
                draw_dispersion(folder, fit, about["noise_m_s"])
            except ValueError as error:
                print(f"no dispersion curve: {error}")
    except (OSError, KeyError, json.JSONDecodeError) as error:
        print(f"{folder}: {error}", file=sys.stderr)
        return ENVIRONMENT
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(Path, sys.argv[1:])))
