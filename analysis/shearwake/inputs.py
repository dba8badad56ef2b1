# SPDX-License-Identifier: BSD-3-Clause
"""Files of users: the links that no reader follows, maps of material properties and imported k-Wave studies."""
from __future__ import annotations

import contextlib
import itertools
import math
import os
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import h5py
import numpy as np


AXES = ("x_m", "y_m", "z_m")
ALLOWED_B, MOST_COMPRESSION = 64_000_000, 100  # as in src/storage/hdf5/h5_block.cpp
MOST_DEFLATE, MOST_CHUNKS = 1032, 200_000  # gzip compresses by at most this factor; the chunks are examined in about 1 s

MOST_DIMENSIONS = 4  # of files of this program: volumes over time

examined: set[tuple[int, ...]] = set()  # whether numbers only; device, inode, size and time of change of files without such links


class BadLink(OSError):
    """A file refers to another file, or claims far more values than it stores."""


def open_self_contained(path: Path, require_numbers: bool = False) -> h5py.File:
    """Opens an HDF5 file for reading. Raises OSError, and BadLink if one of its links leads to another file, if the values of
    a dataset are in other files, if a compressed or unwritten dataset claims more than ALLOWED_B and MOST_COMPRESSION times
    what it stores, if a chunk has or decompresses to more than its dataset, or if the file is sparse. Files of this program
    contain nothing but arrays of numbers, and no soft links."""
    require_regular(path)
    refuse_holes(path)
    file, status = h5py.File(path, "r"), os.stat(path)
    stamp = (require_numbers, status.st_dev, status.st_ino, status.st_size, status.st_ctime_ns)
    try:
        if stamp not in examined:
            _refuse_links(file, require_numbers)
            examined.add(stamp)
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


def require_regular(path: Path) -> None:
    """Raises FileNotFoundError, and OSError for anything but a regular file: pipes and devices may block or be endless."""
    if not Path(path).exists():
        raise FileNotFoundError(f"{path} does not exist")
    if not Path(path).is_file():
        raise OSError(f"{path} is not a regular file")


def text_of(path: Path, encoding: str = "utf-8", errors: str = "strict") -> str:
    """The text of a regular file that is not sparse. Raises OSError, and ValueError for other bytes."""
    require_regular(path)
    refuse_holes(path)
    return path.read_text(encoding=encoding, errors=errors)


def refuse_holes(path: Path) -> None:
    """Raises BadLink if the file system stores less than a MOST_COMPRESSION-th of a file above ALLOWED_B."""
    size, stored, end = os.stat(path).st_size, 0, 0
    if size <= ALLOWED_B:
        return
    with open(path, "rb") as file:
        while MOST_COMPRESSION * stored < size:
            try:
                start = os.lseek(file.fileno(), end, os.SEEK_DATA)
            except OSError as error:  # nothing but a hole is left
                raise BadLink(f"it is a sparse file: it has {size / 1e6:.0f} MB but stores {stored / 1e3:.3g} kB") from error
            end = os.lseek(file.fileno(), start, os.SEEK_HOLE)
            stored += end - start


def _refuse_links(file: h5py.File, require_numbers: bool) -> None:
    total = [0, 0]

    def visit(name: bytes, link: Any) -> Exception | None:
        try:
            _refuse_link(file, name, link.type, total)
            if require_numbers:
                _refuse_other_contents(file, name, link.type)
        except Exception as error:  # noqa: BLE001 - h5py 3.7 requires that the function returns
            return error
        return None

    if error := file.id.links.visit(visit, info=True):
        raise error
    claimed, stored = total
    _refuse_claims("the file contains values", claimed, stored, 3 * ALLOWED_B)


def shown(text: bytes | str) -> str:
    """A text of a file without characters that a terminal interprets."""
    return "".join(c if c.isprintable() else "?" for c in (text.decode("utf-8", "replace") if isinstance(text, bytes) else text))


def _refuse_link(file: h5py.File, name: bytes, kind: int, total: list[int]) -> None:
    """Adds the bytes that a dataset claims and stores to the total."""
    where = "/" + shown(name)
    if kind > h5py.h5l.TYPE_SOFT:
        other = shown(file.id.links.get_val(name)[0]) + ", " if kind == h5py.h5l.TYPE_EXTERNAL else ""
        raise BadLink(f"the link {where} leads to another file, {other}which is not read")
    item = h5py.h5o.open(file.id, name) if kind == h5py.h5l.TYPE_HARD else None
    if isinstance(item, h5py.h5d.DatasetID):
        values, stored = item.get_space().get_simple_extent_npoints(), item.get_storage_size()
        claimed = values * item.get_type().get_size()
        if item.get_offset() is None:  # not in one piece of this file
            _refuse_storage(item, where, claimed)
        _refuse_claims(f"the dataset {where} has {values} values", claimed, stored, ALLOWED_B)
        total[0] += claimed
        total[1] += stored


def _refuse_other_contents(file: h5py.File, name: bytes, kind: int) -> None:
    item = h5py.h5o.open(file.id, name) if kind == h5py.h5l.TYPE_HARD else None
    is_number = isinstance(item, h5py.h5d.DatasetID) and item.get_type().get_class() in (h5py.h5t.FLOAT, h5py.h5t.INTEGER)
    if not isinstance(item, h5py.h5g.GroupID) and not (is_number and item.rank <= MOST_DIMENSIONS):
        raise OSError(f"/{shown(name)} is not an array of numbers with at most {MOST_DIMENSIONS} dimensions")


def _refuse_storage(data: h5py.h5d.DatasetID, where: str, claimed: int) -> None:
    creation = data.get_create_plist()
    if creation.get_external_count() > 0 or creation.get_layout() == h5py.h5d.VIRTUAL:
        raise BadLink(f"the dataset {where} stores its values in another file, which is not read")
    if creation.get_layout() == h5py.h5d.CHUNKED:
        _refuse_chunks(data, where, creation.get_chunk(), claimed)


def _refuse_claims(what: str, claimed: int, stored: int, allowed: int) -> None:
    if claimed > max(allowed, MOST_COMPRESSION * stored):
        raise BadLink(f"{what} ({claimed / 1e6:.0f} MB) but stores {stored / 1e3:.3g} kB; at "
                      f"most {allowed / 1e6:.0f} MB, or {MOST_COMPRESSION} times what is stored, are read: store it without "
                      "compression if this size is intended")


def _refuse_chunks(data: h5py.h5d.DatasetID, where: str, shape: tuple[int, ...], claimed: int) -> None:
    """HDF5 allocates complete chunks, and does not limit what the bytes of a chunk decompress to."""
    chunk_B = math.prod(shape) * data.get_type().get_size()
    if chunk_B > max(ALLOWED_B, claimed):
        raise BadLink(f"a chunk of the dataset {where} has {chunk_B / 1e6:.0f} MB, more than the dataset")
    if MOST_DEFLATE * data.get_storage_size() <= ALLOWED_B:
        return
    corners = [range(0, n, step) for n, step in zip(data.shape, shape)]
    if math.prod(map(len, corners)) > MOST_CHUNKS:
        raise BadLink(f"the dataset {where} has more than {MOST_CHUNKS} chunks: store it in larger ones, or without compression")
    for corner in itertools.product(*corners):
        if MOST_DEFLATE * data.get_chunk_info_by_coord(corner).size > ALLOWED_B:
            rest, found, unpacked = data.read_direct_chunk(corner)[1], 0, zlib.decompressobj()
            with contextlib.suppress(zlib.error):  # not compressed, or damaged, which HDF5 reports
                while rest and found <= 2 * chunk_B:  # another filter may have added a checksum
                    found += len(unpacked.decompress(rest, 1 << 22))
                    rest = unpacked.unconsumed_tail
            if found > 2 * chunk_B:
                raise BadLink(f"a chunk of the dataset {where} decompresses to more than the {chunk_B} bytes that it states")


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


def study_grid(path: Path) -> tuple[np.ndarray, np.ndarray]:
    """The numbers of points and the spacings in m of a study along x, y and z. Raises OSError and KeyError."""
    with opened(path) as file:
        return file["grid/points"][()].astype(int), file["grid/spacing_m"][()]


def read_study(path: Path) -> GridStudy:
    """The grid and the nodes of a study. Raises OSError and KeyError."""
    none = np.empty((0, 3), dtype=int)
    points, spacing_m = study_grid(path)
    with opened(path) as file:
        sources = [file[name]["nodes"][()].astype(int) for name in file if name.startswith("source_") and "nodes" in file[name]]
        sensors = file["sensor/nodes"][()].astype(int) if "sensor/nodes" in file else none
        return GridStudy(points, spacing_m, file["medium/c_s_m_s"][()], np.concatenate([none, *sources]), sensors)
