# SPDX-License-Identifier: BSD-3-Clause
"""Scans as named arrays: files of MATLAB (version 5 through scipy, 7.3 through h5py) and HDF5."""
import math
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import h5py
import numpy as np

from ..inputs import BadLink, open_self_contained
from .scan import MOST_VALUES, BadScan, Scan
from .scan_settings import DELAYS, NOT_A_SCAN, SETTINGS, has_meaning, is_ignored, settings
from .units import LENGTHS, TIMES, UNIT, UNLABELLED, check_unit, is_unit_name, plain_unit, refuse_foreign, speed_of, text_of

Getter = Callable[[str], Any]  # returns None for names that do not exist
Place = tuple[Iterable[str], Getter]


def named(get: Getter, names: tuple[str, ...], what: str) -> Any:
    found = {name: value for name in names if (value := get(name)) is not None}
    if len(found) > 1:
        raise BadScan(f"it contains both {' and '.join(found)}; only one of them can be the {what}")
    if not found:
        raise BadScan(f"{NOT_A_SCAN}it has no {what} ({', '.join(names)})")
    return next(iter(found.values()))


KNOWN = ("time", "t", "x", "y", "velocity", "v", "quality", "point", *DELAYS, *SETTINGS)


def stated_in(places: list[Place]) -> dict[str, Any]:
    """The settings and units that the places of a file state, and what else may state how values are meant."""
    found: dict[str, Any] = {}
    for names, get in places:
        for name in filter(has_meaning, names):
            if (value := get(name)) is None and name not in KNOWN:
                continue  # a group, or a link to nothing
            if not agree(found.setdefault(name, value), value):
                raise BadScan(f"it states {name} twice, as {text_of(found[name])[:20]} and {text_of(value)[:20]}")
    return found


def agree(one: Any, other: Any) -> bool:
    """Whether texts are equal, or numbers that may be stored in single precision."""
    try:
        return text_of(one) == text_of(other) or np.allclose(np.asarray(one, float), np.asarray(other, float), rtol=1e-6, atol=0.0)
    except (TypeError, ValueError):
        return False


def from_names(places: list[Place], notes: list, order_is_known: bool = False, order: str = "") -> Scan:
    """A scan from named arrays with the indices (point, time) or (time, point). The first place contains the arrays, all may
    contain settings and units. `order`: how indices are counted, as the end of a note."""
    names, get = places[0]

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

    stored_time = np.ravel(named(get, ("time", "t"), "time"))
    time = numbers(stored_time, "time")
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

    stated = stated_in(places)
    for name, text in stated.items():
        check_unit(name, text)
    others = [name for name in names if name not in KNOWN and not is_unit_name(name)]
    if unread := list(dict.fromkeys([*others, *(name for name, value in stated.items() if is_ignored(name, value))])):
        notes.append(f"without effect: {', '.join(unread)[:120]}")
    rounding = 0.0
    if stored_time.dtype.itemsize < 8 and stored_time.dtype.kind == "f" and len(time) > 1 and time[-1] > time[0]:
        # One unit in the last place: half of one by storage, and half of one if times in ms were multiplied by a factor.
        rounding = 2.0 * float(np.spacing(np.max(np.abs(stored_time)))) / (time[-1] - time[0])
    return Scan(time, x, y, np.ascontiguousarray(velocity), None if quality is None else numbers(quality, "quality").ravel(),
                rate_rounding=rounding, **settings(stated, one, notes))


def stated_factor(data: Any, name: str, notes: list) -> float:
    """The factor to SI units that the attribute `units` of a dataset states."""
    text = text_of(next((value for key, value in data.attrs.items() if key.lower() in UNIT), ""))
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


def check_attributes(data: Any, name: str, values: np.ndarray, notes: list) -> None:
    """Rejects attributes of a dataset that change the meaning of its values."""
    for key, value in data.attrs.items():
        if key in ("_FillValue", "missing_value"):
            if name in ("velocity", "v") and np.any(values == value):
                raise BadScan(f"{name} contains its {key}, {text_of(value)}; store NaN for points without signal")
        elif key == "dimension" or (is_unit_name(key) and key.lower() not in UNIT):
            refuse_foreign(f"the attribute {key} of {name}", value)
        elif is_ignored(key, value, f" (attribute of {name})"):
            notes.append(f"without effect: {key} (attribute of {name})")


def scales_of(data: Any) -> list[str]:
    """The name of the scale of each dimension; empty: none."""
    if "DIMENSION_LIST" not in data.attrs:
        return []
    return [dimension[0].name.rpartition("/")[2] if len(dimension) else "" for dimension in data.dims]


def has_values(data: Any) -> bool:
    """Whether a member of a file is a dataset with values: neither an empty one of MATLAB nor a dimension of netCDF alone."""
    return isinstance(data, h5py.Dataset) and not data.attrs.get("MATLAB_empty") \
        and not text_of(data.attrs.get("NAME", "")).startswith("This is a netCDF dimension but not a netCDF variable")


def read_hdf5(path: Path) -> Scan:
    try:
        with open_self_contained(path) as file:
            group = file["vibrometer"] if isinstance(file.get("vibrometer"), h5py.Group) else file
            notes: list[str] = []
            # h5write of MATLAB reverses the indices without an attribute, and stores vectors as matrices.
            vectors = [group[name] for name in ("time", "t", "x", "y") if has_values(group.get(name))]
            of_time = {"time", "t", *(scales_of(vectors[0]) if vectors else [])} - {""}
            as_matlab = bool(vectors) and all(one.ndim == 2 and 1 in one.shape and not one.attrs.keys() for one in vectors)
            if as_matlab:
                notes.append("vectors are stored as matrices, as by MATLAB: the indices are taken in reverse order")

            def get(name: str, where: Any = group) -> Any:
                data = where.get(name, getlink=False) if name in where else None
                if not has_values(data):
                    return None
                if data.size is None or data.size > MOST_VALUES:
                    raise BadScan(f"{name} has {data.size} values, but at most {MOST_VALUES} are supported")
                values = data[()]
                if data.dtype.kind in "fiu":
                    if text_of(data.attrs.get("MATLAB_class", "")) == "char":
                        return "".join(map(chr, values.ravel()))
                    check_attributes(data, name, values, notes)
                    if (factor := stated_factor(data, name, notes)) != 1.0:
                        values = factor * values
                # MATLAB, which writes this attribute, stores the indices in reverse.
                if "MATLAB_class" in data.attrs or as_matlab:
                    return values.T
                return values.T if not of_time.isdisjoint(scales_of(data)[:1]) else values

            def members(where: Any) -> list[str]:
                return [one for name in where for one in ([f"{name}/{part}" for part in where[name]] if is_unit_name(name)
                                                          and isinstance(where.get(name), h5py.Group) else [name])]

            places: list[Place] = [(members(group), get), (group.attrs, group.attrs.get)]
            if group != file:
                places += [(members(file), lambda name: get(name, file)), (file.attrs, file.attrs.get)]
            velocity = next((group[name] for name in ("velocity", "v") if has_values(group.get(name))), None)
            in_matlab = as_matlab or (velocity is not None and "MATLAB_class" in velocity.attrs)
            return from_names(places, notes, velocity is not None and not of_time.isdisjoint(scales_of(velocity)),
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
    except Exception as error:  # noqa: BLE001 - scipy raises many types for damaged files
        raise BadScan(f"it cannot be read as a MATLAB file: {(str(error).splitlines() or [repr(error)])[0]}") \
            from error
    content = {name: values for name, values in content.items() if not name.startswith("__")}
    places = [content]
    if inner := fields_of(content.get("vibrometer")):
        places = [inner, {name: values for name, values in content.items() if name != "vibrometer"}]
    for place in places:
        for name in [name for name in place if is_unit_name(name)]:
            if parts := fields_of(place[name]):
                del place[name]
                place.update({f"{name}.{part}": text for part, text in parts.items()})
    return from_names([(place, place.get) for place in places], [])


def fields_of(struct: Any) -> dict[str, Any]:
    """The fields of a struct of MATLAB; empty for other values."""
    names = getattr(getattr(struct, "dtype", None), "names", None)
    return {name: struct[name].item() for name in names} if names and struct.size == 1 else {}


def write_hdf5(path: Path, scan: Scan) -> None:
    """HDF5 with a MATLAB 7.3 header: `load` of MATLAB and Octave give the variables. Since MATLAB reverses the order of indices,
    velocity is stored as (time, point) and is velocity(point, time) there."""
    with h5py.File(path, "w", userblock_size=512, locking=False) as file:
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
