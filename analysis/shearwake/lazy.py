# SPDX-License-Identifier: BSD-3-Clause
"""Arrays of xarray that are read from case files when their values are needed."""
from __future__ import annotations

import warnings
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import xarray as xr
from xarray.backends import BackendArray
from xarray.core import indexing

from .errors import AxesDiffer, GridsDiffer
from .stored import items, opened, text

SAME = 1e-9  # relative to the largest value; axis values closer than this are equal


def positions(values: np.ndarray, axis: np.ndarray) -> np.ndarray | None:
    """The places of the values on an ascending axis; None if one is not on it."""
    if len(axis) == 0 or len(values) == 0:
        return np.zeros(0, dtype=int) if len(values) == 0 else None
    at = np.clip(np.searchsorted(axis, values), 1, max(len(axis) - 1, 1)) if len(axis) > 1 else np.zeros(len(values), dtype=int)
    if len(axis) > 1:
        at = np.where(np.abs(values - axis[at - 1]) <= np.abs(values - axis[at]), at - 1, at)
    near = np.abs(values - axis[at]) <= SAME * max(float(np.abs(axis).max()), 1e-300)
    return at if near.all() else None


def union(axes: list[np.ndarray], name: str) -> np.ndarray:
    """The values of all axes in ascending order, without values that are equal to the one before. Warns with GridsDiffer if the axes
    differ."""
    if all(len(axis) == len(axes[0]) and np.array_equal(axis, axes[0]) for axis in axes):
        return axes[0]
    warnings.warn(f"the cases have different values of {name}; the dataset contains the values of all of them, and NaN where a case "
                  "has none. Select cases of one grid to avoid this", GridsDiffer, stacklevel=9)
    values = np.unique(np.concatenate(axes))
    tolerance = SAME * float(np.abs(values).max())
    return values[np.concatenate([[True], np.diff(values) > tolerance])]


class Cells(BackendArray):
    """A variable of the files of a grid of cases. A cell without file is NaN. Only the files and parts of files that are
    indexed are opened.

    `files` is an array of paths or None, one per cell; `name` the path of the variable within the file; `axes` the values
    on the dimensions of the variable, and `axis_names` the paths of these axes within the file. The files must have these
    values, or a part of them: the remaining values are NaN.
    """

    def __init__(self, files: np.ndarray, name: str, axis_names: list[str], axes: list[np.ndarray]) -> None:
        self.files, self.name, self.axis_names, self.axes = files, name, axis_names, axes
        self.shape = files.shape + tuple(len(axis) for axis in axes)
        self.dtype = np.dtype(float)

    def __getitem__(self, key: indexing.ExplicitIndexer) -> Any:
        return indexing.explicit_indexing_adapter(key, self.shape, indexing.IndexingSupport.OUTER, self.read)

    def __dask_tokenize__(self) -> tuple[Any, ...]:
        """What dask recognises equal data by: the files, with their times of change, and the variable."""
        return (self.name, self.axis_names, [axis.tolist() for axis in self.axes], self.files.shape, stamps(self.files))

    def read(self, key: tuple[Any, ...]) -> np.ndarray:
        """The values of an index of integers, slices and arrays, each of which acts on its own dimension."""
        rows = [np.arange(n)[part] for n, part in zip(self.shape, key)]
        outer = self.files.ndim
        chosen = self.files[np.ix_(*[np.atleast_1d(part) for part in rows[:outer]])] if outer else self.files
        inner = [np.atleast_1d(part) for part in rows[outer:]]
        values = np.full(chosen.shape + tuple(len(part) for part in inner), np.nan)
        for cell in np.ndindex(chosen.shape):
            if chosen[cell] is not None:
                self.read_file(chosen[cell], inner, values[cell] if inner else values, () if inner else cell)
        return values.reshape([len(part) for part in rows if part.ndim])

    def read_file(self, path: Path, inner: list[np.ndarray], into: np.ndarray, cell: tuple[int, ...]) -> None:
        """Copies the indexed part of a file to `into`. Raises AxesDiffer, Damaged and OSError."""
        with opened(path) as file:
            if not inner:
                into[cell] = file[self.name][()] if self.name in file else np.nan
                return
            if self.name not in file:
                return
            item = file[self.name]
            to, source = [], []
            for number, (name, axis, part) in enumerate(zip(self.axis_names, self.axes, inner)):
                own = axis_of(file, name, item.shape[number])
                place = positions(own, axis)
                if place is None:
                    raise AxesDiffer(f"{path}: the values of {name} differ from those of the other cases in the dataset; "
                                     f"read {self.name} of each case by itself")
                back = np.full(len(axis), -1)
                back[place] = np.arange(len(own))
                found = back[part]
                to.append(np.flatnonzero(found >= 0))
                source.append(found[found >= 0])
            if all(len(part) for part in source):
                # HDF5 reads one box, which contains the indexed values.
                box = tuple(slice(int(part.min()), int(part.max()) + 1) for part in source)
                values = item[box]
                into[np.ix_(*to)] = values[np.ix_(*[part - int(part.min()) for part in source])]


def stamps(files: np.ndarray) -> list[Any]:
    """The path and the time of change of each file; None for no file."""
    return [None if path is None else (str(path), path.stat().st_mtime_ns) for path in files.flat]


def axis_of(file: h5py.File, name: str, length: int) -> np.ndarray:
    """The values of an axis, where those without unit (numbers of traces, receptors and spikes) are integers; the numbers of its
    points if the file contains no values."""
    if not name or name not in file:
        return np.arange(length)
    item = file[name]
    values = item[()]
    return values.astype(int) if text(item.attrs.get("units", "")) == "1" else values


def lazy(array: BackendArray, dims: list[str], attributes: dict[str, Any]) -> xr.Variable:
    """A variable of xarray that reads its values when they are needed, and keeps them."""
    read_late: Any = indexing.LazilyIndexedArray(array)  # of xarray, whose releases state its type differently
    return xr.Variable(dims, indexing.MemoryCachedArray(indexing.CopyOnWriteArray(read_late)), attributes)


def of_group(path: Path, group: str) -> xr.Dataset:
    """A group of a case file. Its axes are read now, its other variables when they are needed."""
    found = items(path, group)
    file = np.empty((), dtype=object)
    file[()] = path
    with opened(path) as content:
        axes = {item.path: axis_of(content, item.path, item.shape[0]) for name, item in found.items() if item.dims == (name,)}
    variables, coordinates = {}, {}
    for name, item in found.items():
        if item.dims == (name,):
            coordinates[name] = xr.Variable(item.dims, axes[item.path], item.attributes)
            continue
        own = [axes.get(axis, np.arange(length)) for axis, length in zip(item.axis_paths, item.shape)]
        variables[name] = lazy(Cells(file, item.path, list(item.axis_paths), own), list(item.dims), item.attributes)
    return xr.Dataset(variables, coordinates)
