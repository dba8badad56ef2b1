# SPDX-License-Identifier: BSD-3-Clause
"""Files of users: the links that no reader follows, and maps of material properties."""
from __future__ import annotations

import contextlib
import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np


AXES = ("x_m", "y_m", "z_m")


class BadLink(OSError):
    """A file refers to another file."""


def open_self_contained(path: Path) -> h5py.File:
    """Opens an HDF5 file for reading. Raises OSError, and BadLink if one of its links leads to another file, or if the values of
    a dataset are in other files."""
    require_regular(path)
    file = h5py.File(path, "r", locking=False)
    try:
        if error := file.id.links.visit(lambda name, link: problem_of_link(file, name, link.type), info=True):
            raise error
    except (KeyError, ValueError, TypeError) as error:  # raised by h5py for damaged files
        file.close()
        raise OSError(f"it is damaged: {error}") from error
    except BaseException:
        file.close()
        raise
    return file


@contextlib.contextmanager
def opened(path: Path) -> Iterator[h5py.File]:
    """A file of a user, open for reading. Raises KeyError if something that is read is missing, and OSError if the file cannot
    be read or has other contents in its place, for which h5py and numpy raise many types."""
    try:
        with open_self_contained(path) as file:
            yield file
    except (RuntimeError, TypeError, ValueError, AttributeError, IndexError) as error:
        raise OSError(f"{path} is damaged: {error}") from error


def case_files(folder: Path) -> list[Path]:
    """The case files of a folder, in the order of their ids. Copies that other programs make, such as `<id> (1).h5` and `._<id>.h5`,
    are omitted."""
    return sorted(path for path in folder.glob("*.h5") if re.fullmatch("[0-9a-f]+", path.stem))


def require_regular(path: Path) -> None:
    """Raises FileNotFoundError, and OSError for anything but a regular file: pipes and devices may block or be endless."""
    if not Path(path).exists():
        raise FileNotFoundError(f"{path} does not exist")
    if not Path(path).is_file():
        raise OSError(f"{path} is not a regular file")


def text_of(path: Path, encoding: str = "utf-8", errors: str = "strict") -> str:
    """The text of a regular file. Raises OSError, and ValueError for other bytes."""
    require_regular(path)
    return path.read_text(encoding=encoding, errors=errors)


def shown(text: bytes | str) -> str:
    """A text of a file without characters that a terminal interprets."""
    return "".join(c if c.isprintable() else "?" for c in (text.decode("utf-8", "replace") if isinstance(text, bytes) else text))


def problem_of_link(file: h5py.File, name: bytes, kind: int) -> Exception | None:
    """What is wrong with a link; h5py 3.7 requires that the function that visits links raises nothing."""
    where = "/" + shown(name)
    try:
        if kind > h5py.h5l.TYPE_SOFT:
            other = shown(file.id.links.get_val(name)[0]) + ", " if kind == h5py.h5l.TYPE_EXTERNAL else ""
            return BadLink(f"the link {where} leads to another file, {other}which is not read")
        item = h5py.h5o.open(file.id, name) if kind == h5py.h5l.TYPE_HARD else None
        if isinstance(item, h5py.h5d.DatasetID) and item.get_offset() is None:  # not in one piece of this file
            creation = item.get_create_plist()
            if creation.get_external_count() > 0 or creation.get_layout() == h5py.h5d.VIRTUAL:
                return BadLink(f"the dataset {where} stores its values in another file, which is not read")
    except Exception as error:  # noqa: BLE001 - of h5py, for damaged files
        return error
    return None


@dataclass(frozen=True)
class MaterialMap:
    """Shear-wave speeds c_s_m_s(x, y, z) at the nodes x_m, y_m, z_m of a regular grid."""

    x_m: np.ndarray
    y_m: np.ndarray
    z_m: np.ndarray
    c_s_m_s: np.ndarray


def read_map(path: Path) -> MaterialMap:
    """The shear-wave speed of a map. Raises OSError, and KeyError if the map does not contain it."""
    with opened(path) as file:
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
