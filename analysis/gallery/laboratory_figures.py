# SPDX-License-Identifier: BSD-3-Clause
"""Pictures of jobs/lens-letter.toml and jobs/read-back.toml: a lens with its field, and a scan that is measured and fitted."""
import csv
import json
import tempfile
import tomllib
from pathlib import Path
from typing import Any

import h5py
import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Polygon

from shearwake import wake
from shearwake.report import style
from shearwake.report.load import load, surface

from .scan_studies import shearwake

ROOT = Path(__file__).resolve().parents[2]
DPI = 200
Picture = tuple[Any, np.ndarray]  # the edges in mm, and the values with y upwards


def square_map(path: Path) -> Picture:
    """The edges of a square table (x_mm, y_mm, value) and its values as a picture with y upwards."""
    with open(path, encoding="utf-8") as file:
        x, _, values = np.array(list(csv.reader(file))[1:], dtype=float).T
    side = round(np.sqrt(len(x)))
    half = 0.5 * (x.max() - x.min()) / (side - 1)
    return (x.min() - half, x.max() + half) * 2, values.reshape(side, side).T


def surface_of(folder: Path, case: int = 0, time: int = -1) -> tuple[np.ndarray, np.ndarray, tuple[np.ndarray, np.ndarray]]:
    """A snapshot of a complete case of an output folder: extent in mm, displacement in um with y upwards, x and y in mm."""
    found = surface([c for c in load(folder).cases if c.is_complete][case], time)
    if found is None:
        raise ValueError(f"{folder} contains no snapshot")
    _, x, y, u = found
    return 1e3 * np.array(wake.extent(x, y)), 1e6 * u.T, (1e3 * x, 1e3 * y)


def panel(figure: Figure, axes: Axes, picture: Picture, title: str, label: str, **options: Any) -> None:
    extent, values = picture
    image = axes.imshow(values, origin="lower", extent=extent, **options)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", title=title)
    axes.grid(False)
    bar = figure.colorbar(image, ax=axes, orientation="horizontal", shrink=0.9, pad=0.02)
    bar.set_label(label)
    bar.outline.set_linewidth(0.5)
    bar.ax.grid(False)


def save(figure: Figure, picture: Path) -> None:
    figure.savefig(picture, dpi=DPI, facecolor="white")
    plt.close(figure)


def lens_letter(folder: Path, picture: Path) -> None:
    """The thickness of the lens, its pressure on the skin with the outline of the target, and the displacement."""
    job = ROOT / "jobs" / "lens-letter.toml"
    outline = tomllib.loads(job.read_text(encoding="utf-8"))["load"]["footprint"]["target_polygon_mm"]
    with tempfile.TemporaryDirectory() as lens:
        shearwake("lens", job, "--out", lens)
        extent, thickness = square_map(Path(lens) / "thickness.csv")
        field = square_map(Path(lens) / "field.csv")
    skin_extent, u_um, _ = surface_of(folder, case=1, time=0)
    figure, axes = plt.subplots(1, 3, figsize=(9.6, 4.0), constrained_layout=True)
    panel(figure, axes[0], (extent, np.where(thickness > 0.0, thickness, np.nan)), "lens of 150 mm", "thickness (mm)", cmap="cividis")
    panel(figure, axes[1], field, "sound on the skin", "radiation pressure / peak", cmap="magma", vmin=0.0, vmax=1.0)
    end = np.max(np.abs(u_um))
    panel(figure, axes[2], (skin_extent, u_um), "skin after 10 ms, AM at 150 Hz", "$u_z$ (µm), positive into the skin",
          cmap=style.DIVERGING, vmin=-end, vmax=end)
    for one, colour in ((axes[1], "white"), (axes[2], style.INK)):
        one.add_patch(Polygon(outline, fill=False, edgecolor=colour, linewidth=0.9, linestyle=(0, (4, 2))))
        one.set(xlim=(-60.0, 60.0), ylim=(-60.0, 60.0))
    save(figure, picture)


def read_back(_folder: Path, picture: Path) -> None:
    """The simulated surface, that from its scan, their difference, and the residuals of the fit."""
    jobs = ROOT / "jobs"
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        shearwake("run", jobs / "virtual-experiment.toml", "--out", folder / "true")
        shearwake("reduce", folder / "true")
        data = next((folder / "true" / "cases").glob("*.h5"))
        shearwake("fit", jobs / "read-back.toml", "--data", data, "--out", folder / "fit")
        shearwake("measure", data, "--options", jobs / "read-back.toml", "--fit", folder / "fit" / "fit.json", "--out",
                  folder / "measured", "--no-report", "--repetitions", "0")
        extent, true, (x_mm, y_mm) = surface_of(folder / "true")
        _, measured, _ = surface_of(folder / "measured")
        estimates = json.loads((folder / "fit" / "fit.json").read_text())["estimates"]
        with h5py.File(folder / "fit" / "fit.h5", "r") as file:
            x, y, residual = (file[key][()] for key in ("x", "y", "residual_rms"))
    figure, axes = plt.subplots(2, 2, figsize=(7.2, 8.2), constrained_layout=True)
    axes = axes.ravel()
    options = {"cmap": style.DIVERGING, "vmin": -2.0, "vmax": 2.0}
    label = "$u_z$ (µm), clipped at 2 µm"
    panel(figure, axes[0], (extent, true), "simulation, 30 ms", label, **options)
    panel(figure, axes[1], (extent, measured), "measured: 4 mm, noise, gaps", label, **options)
    end = np.max(np.abs((measured - true)[np.ix_(*(np.abs(values) <= 32.0 for values in (y_mm, x_mm)))]))
    panel(figure, axes[2], (extent, measured - true), "measured - simulation", "$u_z$ (µm)", cmap=style.DIVERGING, vmin=-end, vmax=end)
    points = axes[3].scatter(1e3 * x, 1e3 * y, c=1e6 * residual, s=9, cmap="viridis")
    axes[3].set(xlabel="x (mm)", ylabel="y (mm)", title="residuals of the fit", aspect="equal")
    axes[3].grid(False)
    figure.colorbar(points, ax=axes[3], orientation="horizontal", shrink=0.9, pad=0.02).set_label("rms (µm/s)")
    for one in axes:
        one.set(xlim=(-33.0, 33.0), ylim=(-33.0, 33.0))
    figure.suptitle(", ".join(f"{label} = {estimates[key]['value']:.4f} ± {estimates[key]['standard_error']:.1g} {unit}" for key, label, unit in (
        ("medium.layer[1].c_s_m_s", "fit: c_s", "m/s"), ("medium.layer[1].viscosity_Pa_s", "viscosity", "Pa s"))), fontsize=9.5)
    save(figure, picture)
