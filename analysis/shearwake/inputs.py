# SPDX-License-Identifier: BSD-3-Clause
"""Files of users: the links that no reader follows, maps of material properties and imported k-Wave studies."""
from __future__ import annotations

import os
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np


AXES = ("x_m", "y_m", "z_m")
ALLOWED_B, MOST_COMPRESSION = 64_000_000, 100  # as in src/storage/hdf5/h5_block.cpp


class BadLink(OSError):
    """A file refers to another file, or claims far more values than it stores."""


def open_self_contained(path: Path) -> h5py.File:
    """Opens the HDF5 file of a user for reading. Raises OSError, and BadLink if one of its links leads to another file, if
    the values of a dataset are in other files, or if a compressed or unwritten dataset claims more than ALLOWED_B and
    MOST_COMPRESSION times what it stores, or if the file is sparse."""
    if not Path(path).is_file():
        raise OSError(f"{path} is not a regular file" if Path(path).exists() else f"{path} does not exist")
    refuse_holes(path)
    file = h5py.File(path, "r")
    try:
        _refuse_links(file)
    except BaseException:
        file.close()
        raise
    return file


def refuse_holes(path: Path) -> None:
    """Raises BadLink if the file system stores less than a MOST_COMPRESSION-th of a file above ALLOWED_B."""
    with open(path, "rb") as file:
        size, stored, end = os.fstat(file.fileno()).st_size, 0, 0
        while size > ALLOWED_B and MOST_COMPRESSION * stored < size:
            try:
                start = os.lseek(file.fileno(), end, os.SEEK_DATA)
            except OSError as error:  # nothing but a hole is left
                raise BadLink(f"it is a sparse file: it has {size / 1e6:.0f} MB but stores {stored / 1e3:.3g} kB") from error
            end = os.lseek(file.fileno(), start, os.SEEK_HOLE)
            stored += end - start


def _refuse_links(file: h5py.File) -> None:
    seen, groups = set(), [file]
    while groups:
        group = groups.pop()
        for name in group:
            link = group.get(name, getlink=True)
            where = f"{group.name.rstrip('/')}/{name}"
            if isinstance(link, h5py.ExternalLink):
                raise BadLink(f"the link {where} leads to another file, {link.filename}, which is not read")
            if not isinstance(link, h5py.HardLink):
                continue
            item = group[name]
            address = h5py.h5o.get_info(item.id).addr
            if address in seen:
                continue
            seen.add(address)
            if isinstance(item, h5py.Group):
                groups.append(item)
            elif isinstance(item, h5py.Dataset):
                _refuse_claims(item, where)


def _refuse_claims(data: h5py.Dataset, where: str) -> None:
    if data.external or data.is_virtual:
        raise BadLink(f"the dataset {where} stores its values in another file, which is not read")
    claimed, stored = data.nbytes, data.id.get_storage_size()
    if claimed > max(ALLOWED_B, MOST_COMPRESSION * stored):
        raise BadLink(f"the dataset {where} has {data.size} values ({claimed / 1e6:.0f} MB) but stores {stored / 1e3:.3g} kB; at "
                      f"most {ALLOWED_B / 1e6:.0f} MB, or {MOST_COMPRESSION} times what is stored, are read: store it without "
                      "compression if this size is intended")


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
    with open_self_contained(path) as file:
        axes = [file[name][()].ravel() for name in AXES]
        return MaterialMap(axes[0], axes[1], axes[2], in_order(file["c_s_m_s"], tuple(len(axis) for axis in axes)))


def in_order(data: h5py.Dataset, shape: tuple[int, ...]) -> np.ndarray:
    """The values with the indices (x, y, z), as the program reads them: MATLAB stores them in reverse, and dimension scales state
    their order."""
    values = data[()]
    if "MATLAB_class" in data.attrs:
        return values.T
    scales = [dimension[0].name.rpartition("/")[2] if len(dimension) else "" for dimension in data.dims]
    if sorted(scales) == sorted(AXES):
        return values.transpose([scales.index(axis) for axis in AXES])
    return values.T if values.shape != shape and values.shape == shape[::-1] else values


def study_grid(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of points and the spacings in m of a study along x, y and z. Raises OSError and KeyError."""
    with open_self_contained(path) as file:
        return file["grid/points"][()].astype(int), file["grid/spacing_m"][()]


def read_study(path: Path) -> GridStudy:
    """The grid and the nodes of a study. Raises OSError and KeyError."""
    none = np.empty((0, 3), dtype=int)
    points, spacing_m = study_grid(path)
    with open_self_contained(path) as file:
        sources = [file[name]["nodes"][()].astype(int) for name in file if name.startswith("source_") and "nodes" in file[name]]
        sensors = file["sensor/nodes"][()].astype(int) if "sensor/nodes" in file else none
        return GridStudy(points, spacing_m, file["medium/c_s_m_s"][()], np.concatenate([none, *sources]), sensors)
