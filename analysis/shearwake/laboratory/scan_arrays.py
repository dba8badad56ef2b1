# SPDX-License-Identifier: BSD-3-Clause
"""Scans as named arrays: files of MATLAB (version 5 through scipy, 7.3 through h5py) and HDF5."""
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import numpy as np

from ..inputs import BadLink, open_self_contained
from .scan import MOST_VALUES, BadScan, Scan
from .scan_settings import DELAYS, NOT_A_SCAN, SETTINGS, settings
from .units import LENGTHS, TIMES, UNLABELLED, check_unit, plain_unit, speed_of

Getter = Callable[[str], Any]


def named(get: Getter, names: tuple[str, ...], what: str) -> Any:
    for name in names:
        value = get(name)
        if value is not None:
            return value
    raise BadScan(f"{NOT_A_SCAN}it has no {what} ({', '.join(names)})")


KNOWN = ("time", "t", "x", "y", "velocity", "v", "quality", "point", *DELAYS, *SETTINGS)


def from_names(names: Iterable[str], get: Getter, notes: list, order_is_known: bool = False, order: str = "") -> Scan:
    """A scan from named arrays with the indices (point, time) or (time, point); get(name) returns an array or None. `order`: how
    indices are counted, as the end of a note."""
    def numbers(value: Any, what: str) -> np.ndarray:
        try:
            array = np.asarray(value)
            if array.size > MOST_VALUES:
                raise BadScan(f"{what} has {array.size} values, but at most {MOST_VALUES} are supported")
            if array.dtype.kind not in "fiu":
                raise BadScan(f"{what} is not an array of real numbers")
            return array.astype(float)
        except (TypeError, ValueError) as error:
            raise BadScan(f"{what} is not an array of real numbers") from error

    time = numbers(named(get, ("time", "t"), "time"), "time").ravel()
    x = numbers(named(get, ("x",), "x"), "x")
    y = numbers(named(get, ("y",), "y"), "y")
    if x.ndim > 1 and min(x.shape) > 1:
        notes.append("x and y are matrices; their points are counted along the first index first, as x(:) of MATLAB")
    x, y = x.ravel(order="F"), y.ravel(order="F")
    velocity = np.atleast_2d(numbers(named(get, ("velocity", "v"), "velocity"), "velocity"))
    if velocity.shape == (len(time), len(x)):
        if velocity.shape != (len(x), len(time)):
            velocity = velocity.T
        elif not order_is_known:
            notes.append("the file contains as many points as times; the first index of velocity is taken as that of the point" + order)
    quality = get("quality")

    def one(value: Any, name: str) -> float:
        value = numbers(value, name)
        if value.size != 1 or not math.isfinite(value.item()):
            raise BadScan(f"{name} must be one finite number")
        return value.item()

    given = {name: get(name) for name in names if name in DELAYS or name in SETTINGS}
    others = {name: None for name in names if name not in given}
    for name in others:
        if name.lower().endswith(("unit", "units")) and (stated := np.asarray(get(name))).size == 1:
            check_unit(name, stated.item())
    if unread := [name for name in others if name not in KNOWN and not name.startswith("__")]:
        notes.append(f"without effect: {', '.join(unread)[:120]}")
    return Scan(time, x, y, np.ascontiguousarray(velocity), None if quality is None else numbers(quality, "quality").ravel(),
                **settings({**given, **others}, one, notes))


def stated_factor(data: Any, name: str, notes: list) -> float:
    """The factor to SI units that the attribute `units` of a dataset states."""
    text = next((value for key, value in data.attrs.items() if key.lower() in ("unit", "units")), b"")
    text = text.decode("utf-8", "replace") if isinstance(text, bytes) else str(text)
    unit, kind = plain_unit(text), name.partition("_")[0]
    if unit in (*UNLABELLED, "si") or kind not in ("x", "y", "time", "t", "trigger", "velocity", "v"):
        return 1.0
    factor = speed_of(unit) if kind in ("velocity", "v") else (LENGTHS if kind in ("x", "y") else TIMES).get(unit)
    if factor is None or (kind == "trigger" and factor != DELAYS[name] and name != "trigger_delay"):
        raise BadScan(f"the unit of {name} is \"{text[:20]}\" (attribute units), which cannot be read")
    if kind == "trigger" and name != "trigger_delay":
        return 1.0  # the name states the unit
    if factor != 1.0:
        notes.append(f"{name} in {text} (attribute units)")
    return factor


def scales_of(data: Any) -> list[str]:
    """The names of the scales of two dimensions; empty if one has none."""
    if "DIMENSION_LIST" not in data.attrs or data.ndim != 2:
        return []
    return [dimension[0].name.rpartition("/")[2] for dimension in data.dims if len(dimension)]


def read_hdf5(path: Path) -> Scan:
    import h5py

    try:
        with open_self_contained(path) as file:
            group = file["vibrometer"] if "vibrometer" in file else file
            notes: list[str] = []
            # h5write of MATLAB reverses the indices without an attribute, and stores vectors as matrices.
            vectors = [group[name] for name in ("time", "t", "x", "y") if isinstance(group.get(name), h5py.Dataset)]
            as_matlab = bool(vectors) and all(one.ndim == 2 and 1 in one.shape and not one.attrs.keys() for one in vectors)
            if as_matlab:
                notes.append("vectors are stored as matrices, as by MATLAB: the indices are taken in reverse order")

            def get(name: str) -> Any:
                data = group.get(name, getlink=False) if name in group else None
                if not isinstance(data, h5py.Dataset):
                    return None
                if data.size is None or data.size > MOST_VALUES:
                    raise BadScan(f"{name} has {data.size} values, but at most {MOST_VALUES} are supported")
                values = data[()]
                if data.dtype.kind in "fiu" and (factor := stated_factor(data, name, notes)) != 1.0:
                    values = factor * values
                # MATLAB, which writes this attribute, stores the indices in reverse.
                if "MATLAB_class" in data.attrs or as_matlab:
                    return values.T
                return values.T if scales_of(data)[:1] in (["time"], ["t"]) else values

            velocity = next((group[name] for name in ("velocity", "v") if isinstance(group.get(name), h5py.Dataset)), None)
            in_matlab = as_matlab or (velocity is not None and "MATLAB_class" in velocity.attrs)
            return from_names(group, get, notes, velocity is not None and len(scales_of(velocity)) == 2,
                              ", as MATLAB counts indices" if in_matlab else ", as h5py and h5dump count indices; MATLAB and h5write "
                              "reverse them: if they wrote the file, store velocity'")
    except BadLink as error:
        raise BadScan(str(error)) from error
    except (OSError, RuntimeError, KeyError, TypeError, ValueError, AttributeError, MemoryError) as error:
        raise BadScan(f"it cannot be read as HDF5: {(str(error).splitlines() or [repr(error)])[0]}") from error


def read_mat5(path: Path) -> Scan:
    import scipy.io

    try:
        content = scipy.io.loadmat(path)
    except MemoryError as error:
        raise BadScan("it cannot be read as a MATLAB file: it needs more memory than the limit for a file of this size") \
            from error
    except Exception as error:  # noqa: BLE001 - scipy raises many types for damaged files
        raise BadScan(f"it cannot be read as a MATLAB file: {(str(error).splitlines() or [repr(error)])[0]}") \
            from error
    struct = content.get("vibrometer")
    if struct is not None and getattr(struct, "dtype", None) is not None and struct.dtype.names and struct.size == 1:
        return from_names(struct.dtype.names, lambda name: struct[name].item() if name in struct.dtype.names else None, [])
    return from_names(content, content.get, [])


def write_hdf5(path: Path, scan: Scan) -> None:
    """HDF5 with a MATLAB 7.3 header: `load` of MATLAB and Octave give the variables. Since MATLAB reverses the order of indices,
    velocity is stored as (time, point) and is velocity(point, time) there."""
    import h5py

    with h5py.File(path, "w", userblock_size=512) as file:
        arrays = {"time": scan.time_s, "x": scan.x_m, "y": scan.y_m, "velocity": scan.velocity_m_s,
                  "quality": scan.quality, "trigger_delay": scan.trigger_delay_s,
                  "direction_x": scan.direction[0], "direction_y": scan.direction[1],
                  "direction_z": scan.direction[2]}
        for name, values in arrays.items():
            data = file.create_dataset(name, data=np.atleast_2d(np.asarray(values, dtype=float)).T)
            data.attrs["MATLAB_class"] = np.bytes_("double")
    header = b"MATLAB 7.3 MAT-file, written by shearwake"
    with open(path, "r+b") as file:
        file.write(header.ljust(124) + b"\x00\x02IM")
