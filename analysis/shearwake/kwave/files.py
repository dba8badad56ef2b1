# SPDX-License-Identifier: BSD-3-Clause
"""Reads the structures of a k-Wave simulation from the files that MATLAB, Octave, SciPy and h5py write."""
from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
from ..inputs import BadLink, open_self_contained

from .structures import BadInput, Structure, Unreadable, kind_of, text_of
from .variables import NAMES, chosen_variables

# The first fields of each structure, for messages.
EXPECTED = {"kgrid": "'Nx', kgrid.Nx", "medium": "'sound_speed_compression', c_p",
            "source": "'u_mask', u_mask, 'uz', uz", "sensor": "'mask', mask"}
# Datasets of the input of kspaceFirstOrder-OMP and -CUDA.
ACOUSTIC = ("c0", "rho0", "c_ref", "rho0_sgx", "pml_x_size", "p_source_flag", "p0_source_flag", "sensor_mask_type")
MOST_IN_RANGE = 1e7  # numbers of a range, which takes 24 bytes in a file
DEEPEST = 20  # levels of nested cells; links in an HDF5 file may form a circle
OBJECT = ("it is an object, which only MATLAB can read; save a struct or a character array instead "
          "(docs/how-to/kwave.md)")


def decoded(value: Any) -> str:
    if isinstance(value, bytes):
        try:
            value = value.decode("utf-8")
        except UnicodeDecodeError:
            value = value.decode("latin-1")
    return str(value).rstrip("\0 ")


def of_array(values: Any) -> Any:
    """Numbers as float64, texts as str or a list of str. The order of indices is kept."""
    values = np.asarray(values)
    if values.size == 0:
        return None
    if values.dtype.kind in "fiub":
        return values.astype(float)
    if values.dtype.kind in "SU" or (values.dtype.kind == "O" and
                                     all(isinstance(item, (str, bytes)) for item in values.ravel())):
        texts = [decoded(item) for item in values.ravel()]
        return texts[0] if len(texts) == 1 else texts
    if values.dtype.kind == "c":
        return Unreadable("its numbers are complex")
    return Unreadable(f"its type is {values.dtype}")


# ---- HDF5: MATLAB 7.3, h5py, and Octave with save -hdf5. Arrays have reversed indices, as (z, y, x).

def class_of(item: Any) -> str:
    """The MATLAB class; empty for other files."""
    return decoded(item.attrs.get("MATLAB_class", b""))


def characters(values: np.ndarray) -> str | list[str]:
    """The rows of a MATLAB character array."""
    rows = ["".join(chr(int(code)) for code in row).rstrip("\0 ") for row in np.atleast_2d(values.T)]
    return rows[0] if len(rows) == 1 else rows


def of_octave(group: h5py.Group, level: int) -> Any:
    """A value in the format of Octave: datasets or groups `type` and `value`."""
    kind, value = decoded(group["type"][()]), group["value"]
    if isinstance(value, h5py.Group):
        if "cell" in kind:
            return [of_hdf5(value[name], level + 1) for name in sorted(value) if name != "dims"]
        if "struct" in kind:
            return {name: of_hdf5(value[name], level + 1) for name in value}
        return Unreadable(f"Octave has stored it as {kind}")
    if group.attrs.get("OCTAVE_EMPTY_MATRIX") is not None or value.attrs.get("OCTAVE_EMPTY_MATRIX") is not None:
        return None
    if "string" in kind:
        return characters(value[()])
    if "range" in kind:
        base, limit, step = (float(value[()][name]) for name in ("base", "limit", "increment"))
        count = (limit - base) / step * (1 + 1e-15) if step else np.nan
        if not count < MOST_IN_RANGE:  # also for NaN
            raise BadInput(f"a range of Octave from {base:g} to {limit:g} in steps of {step:g} is not one of at most {MOST_IN_RANGE:g} "
                           "numbers")
        return base + step * np.arange(int(np.floor(count)) + 1)
    return of_array(np.asarray(value[()]).T)


def of_dataset(item: h5py.Dataset, level: int) -> Any:
    kind = class_of(item)
    if item.attrs.get("MATLAB_empty", 0) or item.shape is None or item.size == 0:
        return None
    if kind not in ("", "char", "cell", "logical", "double", "single") and not kind.startswith(("int", "uint")):
        return Unreadable(OBJECT)
    if h5py.check_ref_dtype(item.dtype):
        return [of_hdf5(item.file[reference], level + 1) for reference in item[()].T.ravel() if reference] or None
    if kind == "char":
        return characters(item[()])
    if item.dtype.kind == "V":
        return Unreadable("its numbers are complex" if set(item.dtype.names or ()) == {"real", "imag"}
                          else "it is a compound")
    return of_array(np.asarray(item[()]).T)


def of_hdf5(item: Any, level: int = 0) -> Any:
    if level > DEEPEST:
        raise BadInput(f"{item.name} is nested deeper than {DEEPEST} levels")
    if isinstance(item, h5py.Dataset):
        return of_dataset(item, level)
    if "type" in item and "value" in item:
        return of_octave(item, level)
    fields = {name: of_array(value) for name, value in item.attrs.items()
              if not name.startswith(("MATLAB_", "OCTAVE_", "H5PATH"))}
    fields.update({name: of_hdf5(item[name], level + 1) for name in item})
    return fields


def read_hdf5(path: Path) -> tuple[dict[str, Any], list[str]]:
    """The values of the structures, and notes."""
    try:
        file = open_self_contained(path)
    except BadLink as error:
        raise BadInput(str(error)) from error
    with file:
        acoustic = [name for name in ACOUSTIC if name in file]
        if "kgrid" not in file and "elastic_flag" in file and np.all(file["elastic_flag"][()] == 1):
            raise BadInput(f"{path} is an elastic input file of k-Wave: run it with shearwake kwave -i {path} -o OUT.h5")
        if len(acoustic) > 1 and "kgrid" not in file:
            raise BadInput(f"{path} is an input file of the acoustic C++ code of k-Wave (it contains {', '.join(acoustic)}), which has "
                           "no shear waves; save the structures kgrid, medium and source of a simulation for pstdElastic3D instead")
        chosen, notes = chosen_variables(path, [name for name in file if not name.startswith("#")])
        structures = {name: of_hdf5(file[variable]) for name, variable in chosen.items()}
        if not has_known_order(file) and is_cubic(structures.get("kgrid")):
            notes.append("kgrid.Nx and Nz are equal: the arrays of the file are taken as (z, y, x), as MATLAB and k-Wave store them; "
                         "compare the places below")
        return structures, notes


def has_known_order(file: h5py.File) -> bool:
    """Whether MATLAB or Octave has written the file, according to the attributes of an array."""
    found = []
    file.visititems(lambda _, item: found.append(item) if {"MATLAB_class", "OCTAVE_NEW_FORMAT"} & set(item.attrs) else None)
    return bool(found)


def is_cubic(kgrid: Any) -> bool:
    try:
        return float(kgrid["Nx"]) == float(kgrid["Nz"])
    except (KeyError, TypeError, ValueError):
        return False


# ---- .mat files of versions before 7.3: MATLAB, Octave with save -v7, and scipy.io.savemat

def of_mat(value: Any, level: int = 0) -> Any:
    if level > DEEPEST:
        raise BadInput(f"a cell is nested deeper than {DEEPEST} levels")
    if hasattr(value, "toarray"):  # a sparse matrix
        if np.prod(value.shape, dtype=float) > max(MOST_IN_RANGE, 100 * value.nnz):
            return Unreadable(f"it is a sparse matrix of {value.shape[0]} x {value.shape[1]} numbers")
        value = value.toarray()
    if type(value).__name__ in ("MatlabOpaque", "MatlabFunction", "MatlabObject"):
        return Unreadable(OBJECT)
    if not isinstance(value, np.ndarray):
        return of_array(value)
    if value.dtype.names:
        if value.size != 1:
            return Unreadable(f"it is an array of {value.size} structs")
        return {name: of_mat(value.ravel()[0][name], level + 1) for name in value.dtype.names}
    if value.dtype.kind == "O":
        return [of_mat(item, level + 1) for item in value.ravel(order="F")] or None
    return of_array(value)


def variables_of(path: Path) -> list[str]:
    """The names of all variables of a .mat file before version 7.3."""
    import scipy.io
    try:
        names = [name for name, _, _ in scipy.io.whosmat(path)]
    except Exception:  # SciPy cannot list some objects; loadmat reads the other variables, and reports damaged files
        return list(NAMES)
    return [name for name in names if name not in ("", "None") and not name.startswith("__")]


def read_mat(path: Path) -> tuple[dict[str, Any], list[str]]:
    try:
        import scipy.io
    except ImportError as problem:
        raise BadInput(f"{path} is not an HDF5 file; .mat files of versions before 7.3 require SciPy (Debian: "
                       "python3-scipy). In MATLAB, save(file, '-v7.3', ...) writes HDF5") from problem
    try:
        chosen, notes = chosen_variables(path, variables_of(path))
        found = scipy.io.loadmat(path, variable_names=list(chosen.values()))
    except (OSError, BadInput):
        raise
    except Exception as problem:  # SciPy documents no exceptions for damaged files
        raise BadInput(f"{path} is neither an HDF5 file nor a .mat file ({problem}); in MATLAB, use save(file, '-v7.3', ...), in Octave "
                       "save -v7") from problem
    return {name: of_mat(found[variable]) for name, variable in chosen.items() if variable in found}, notes


def of_pairs(values: list[Any]) -> dict[str, Any]:
    """The fields of a cell array of names and values, as k-Wave's functions take them."""
    if len(values) % 2:
        raise BadInput(f"options is a cell array of {len(values)} elements; it must contain pairs of a name and a value")
    names = [text_of(name) for name in values[::2]]
    bad = [n for n, name in enumerate(names) if name is None or not name.isidentifier()]
    if bad:
        at = 2 * bad[0]
        raise BadInput(f"element {at + 1} of options is {kind_of(values[at])}; it must be the name of an option, as in "
                       "{'PMLSize', 10}")
    return {str(name): value for name, value in zip(names, values[1::2])}


def structure_of(name: str, value: Any) -> Structure | None:
    """The structure of a variable; None if it is empty."""
    if name == "options" and isinstance(value, list):
        value = of_pairs(value)
    if value is None or isinstance(value, dict):
        return None if value is None else Structure(value, name)
    if name == "options":
        reason = f"cannot be read: {value.reason}" if isinstance(value, Unreadable) else f"is {kind_of(value)}"
        raise BadInput(f"options {reason}; it must be a struct, or a cell array of names and values as in {{'PMLSize', 10}}")
    found = f" but {kind_of(value)}" if isinstance(value, (np.ndarray, str, list)) else f": {kind_of(value)}"
    raise BadInput(f"{name} is not a structure{found}. Save {name} = struct({EXPECTED[name]}, ...) (docs/how-to/kwave.md)")


def structures(path: Path) -> tuple[dict[str, Structure], list[str]]:
    """{name: Structure} of kgrid, medium and source, and of sensor and options if they exist; and notes."""
    if path.suffix == ".toml" and path.is_file():
        raise BadInput(f"{path} is a job, not a k-Wave simulation; shearwake run {path} computes it")
    if path.exists() and not path.is_file() and not path.is_dir():
        raise BadInput(f"{path} is not a regular file")
    with open(path, "rb"):  # reports a missing file
        pass
    try:
        found, notes = read_hdf5(path) if h5py.is_hdf5(path) else read_mat(path)
    except (RuntimeError, KeyError, ValueError, OSError) as problem:  # raised by h5py for damaged files
        raise BadInput(f"{path} cannot be read: {problem}") from problem
    parts = {name: structure for name in NAMES if name in found and (structure := structure_of(name, found[name])) is not None}
    for name in ("kgrid", "medium", "source"):
        if name not in parts:
            raise BadInput(f"{path} has no structure {name}")
    return parts, notes
