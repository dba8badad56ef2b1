# SPDX-License-Identifier: BSD-3-Clause
"""Files of users that jobs refer to: maps of material properties and imported k-Wave studies."""
from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np


@dataclass(frozen=True)
class MaterialMap:
    """Shear-wave speeds c_s_m_s(x, y, z) at the nodes x_m, y_m, z_m of a regular grid."""

    x_m: np.ndarray
    y_m: np.ndarray
    z_m: np.ndarray
    c_s_m_s: np.ndarray


@dataclass(frozen=True)
class GridStudy:
    """An imported k-Wave study: its grid, its shear-wave speed (a number or an array of the grid's shape), and the indices of
    the nodes of its sources and sensors, with the shape (n, 3)."""

    points: np.ndarray
    spacing_m: np.ndarray
    c_s_m_s: np.ndarray
    source_nodes: np.ndarray
    sensor_nodes: np.ndarray


def read_map(path: Path) -> MaterialMap:
    """The shear-wave speed of a map. Raises OSError, and KeyError if the map does not contain it."""
    with h5py.File(path, "r") as file:
        axes = [np.atleast_1d(file[name][()]) for name in ("x_m", "y_m", "z_m")]
        return MaterialMap(axes[0], axes[1], axes[2], file["c_s_m_s"][()])


def study_grid(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of points and the spacings in m of a study along x, y and z. Raises OSError and KeyError."""
    with h5py.File(path, "r") as file:
        return file["grid/points"][()].astype(int), file["grid/spacing_m"][()]


def read_study(path: Path) -> GridStudy:
    """The grid and the nodes of a study. Raises OSError and KeyError."""
    none = np.empty((0, 3), dtype=int)
    points, spacing_m = study_grid(path)
    with h5py.File(path, "r") as file:
        sources = [file[name]["nodes"][()].astype(int) for name in file if name.startswith("source_") and "nodes" in file[name]]
        sensors = file["sensor/nodes"][()].astype(int) if "sensor/nodes" in file else none
        return GridStudy(points, spacing_m, file["medium/c_s_m_s"][()], np.concatenate([none, *sources]), sensors)
