# SPDX-License-Identifier: BSD-3-Clause
"""Parts of case files as numbers, texts and arrays of numpy."""
from __future__ import annotations

import contextlib
import functools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from .checksum import Damaged
from .inputs import open_self_contained, require_regular
from .keys import described, is_at_instant


@contextlib.contextmanager
def opened(path: Path, open_file: Callable[[Path], h5py.File] = open_self_contained) -> Iterator[h5py.File]:
    """A case file, open for reading. Raises OSError if the file does not exist or may not be read, and Damaged, with the path,
    if it or what is read from it is damaged."""
    try:
        with open_file(path) as file:
            yield file
    except (FileNotFoundError, PermissionError):
        raise
    except (OSError, RuntimeError, TypeError, AttributeError, ValueError) as error:  # of h5py, for other contents
        lines = str(error).splitlines()
        if "unable to lock file" in str(error):
            raise OSError(f"{path} is locked by another program: {lines[0]}") from error
        raise Damaged(f"{path} is not a valid case file: {lines[0] if lines else type(error).__name__}") from error


@dataclass(frozen=True)
class Item:
    """A variable of a case file: its path, the names and paths of its axes, its shape, unit and meaning."""

    path: str
    dims: tuple[str, ...]
    axis_paths: tuple[str, ...]
    shape: tuple[int, ...]
    attributes: dict[str, Any]


def text(value: Any) -> Any:
    """Bytes as text; other values unchanged."""
    return value.decode("utf-8", "replace") if isinstance(value, bytes) else value


def plain(value: Any) -> Any:
    """An HDF5 attribute as text or number."""
    value = text(value)
    return value.item() if hasattr(value, "item") and np.size(value) == 1 else value


def attributes(path: Path, names: Sequence[str] = ()) -> dict[str, Any]:
    """The attributes of the root group, or those of these names that exist. Raises OSError and Damaged."""
    require_regular(path)
    with opened(path, functools.partial(h5py.File, mode="r", locking=False)) as file:  # links to other files do not affect attributes
        return {name: plain(file.attrs[name]) for name in ([n for n in names if n in file.attrs] if names else file.attrs)}


def scalars(path: Path) -> tuple[dict[str, float], dict[str, str], dict[str, Any]]:
    """The scalars of the root group in the order of tables, the reasons of empty ones, and {name: (unit, meaning)}. Raises OSError and
    Damaged."""
    values, notes, units = {}, {}, {}
    with opened(path) as file:
        for name, item in sorted(file.items(), key=lambda entry: is_at_instant(entry[0])):
            if isinstance(item, h5py.Dataset) and item.shape == ():
                values[name] = float(plain(item[()]))
                units[name] = (text(item.attrs.get("units", b"")), text(item.attrs.get("long_name", b"")))
                if "note" in item.attrs:
                    notes[name] = text(item.attrs["note"]).strip("\0")
    return values, notes, units


def array(path: Path, name: str, index: Any = ()) -> np.ndarray:
    """A variable, or the part of it that the index selects. Raises OSError, Damaged and KeyError."""
    with opened(path) as file:
        return file[name][index]


def snapshot(path: Path, index: int) -> tuple[float, np.ndarray, np.ndarray, np.ndarray]:
    """Surface number `index`: t_s, x_m, y_m and u_z_m(x, y) at the first depth. Raises OSError, Damaged, KeyError and IndexError."""
    with opened(path) as file:
        group = file["surface"]
        return (float(group["time"][index]), group["x"][()], group["y"][()], group["u_z"][index, 0])


def arrays(path: Path, group: str = "/", names: Sequence[str] = ()) -> dict[str, np.ndarray]:
    """All variables of a group with at least one dimension, or those of these names that exist. Raises OSError, Damaged and KeyError."""
    with opened(path) as file:
        parent = file[group].id
        found = [name for wanted in names if (name := wanted.encode()) in parent] if names else parent
        opened_now = {name.decode(): h5py.h5o.open(parent, name) for name in found}  # h5py's objects take twice as long to open
        return {name: h5py.Dataset(item)[()] for name, item in opened_now.items() if isinstance(item, h5py.h5d.DatasetID) and item.shape}


def groups(path: Path) -> list[str]:
    """The names of the groups. Raises OSError and Damaged."""
    with opened(path) as file:
        return [name for name, item in file.items() if isinstance(item, h5py.Group)]


def items(path: Path, group: str) -> dict[str, Item]:
    """Describes the variables of a group, without reading them. Raises OSError, Damaged and KeyError."""
    with opened(path) as file:
        return {name: describe(group, name, item) for name, item in file[group].items()
                if isinstance(item, h5py.Dataset)}


def receptor_classes(path: Path) -> np.ndarray:
    """The class of each afferent. Raises OSError, Damaged and KeyError."""
    with opened(path) as file:
        numbers = file["afferents/class"]
        names = [entry.split(": ")[1] for entry in text(numbers.attrs["long_name"]).split(", ")]  # "0: SA1, 1: RA, 2: PC"
        return np.array(names)[numbers[()].astype(int)]


def receptor_colours(path: Path) -> dict[str, str]:
    """The colours of the classes of receptors. Raises OSError, Damaged and KeyError."""
    with opened(path) as file:
        colours = text(file["afferents/class"].attrs["colours"])
        return dict(entry.split(": ") for entry in colours.split(", "))  # "SA1: #009E73, RA: #0072B2"


def describe(group: str, name: str, item: h5py.Dataset) -> Item:
    prefix = "" if group == "/" else group + "/"
    keys = [list(dim.keys()) for dim in item.dims]
    dims = tuple(found[0] if found else (name if item.ndim == 1 else f"{name}_{n}") for n, found in enumerate(keys))
    unit, meaning = (text(item.attrs.get(attribute, b"")) for attribute in ("units", "long_name"))
    return Item(prefix + name, dims, tuple(prefix + dim for dim in dims), item.shape, described(name, unit, meaning))
