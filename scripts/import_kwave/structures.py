# SPDX-License-Identifier: BSD-3-Clause
"""Reads the structures of a k-Wave simulation from an HDF5 file: one that MATLAB wrote (v7.3), or any other
with groups of the same names. Both store arrays with reversed indices, as (z, y, x)."""
import h5py
import numpy as np


class BadInput(Exception):
    """An error that the user can correct."""


class Structure:
    """A struct: fields by name."""

    def __init__(self, group, name):
        self.group, self.name = group, name

    def __contains__(self, field):
        return field in self.group and not self._is_empty(self.group[field])

    @staticmethod
    def _is_empty(item):
        return isinstance(item, h5py.Dataset) and (item.attrs.get("MATLAB_empty", 0) or item.size == 0)

    def fields(self):
        return sorted(field for field in self.group if field in self)

    def array(self, field):
        """The array with the order of indices of MATLAB; the shape of a scalar is ()."""
        item = self.group[field]
        if not isinstance(item, h5py.Dataset) or item.dtype.kind not in "fiub":
            raise BadInput(f"{self.name}.{field} does not contain numbers")
        values = np.asarray(item[()], dtype=float).T
        if not np.all(np.isfinite(values)):
            raise BadInput(f"{self.name}.{field} contains a number that is not finite")
        return values.reshape(()) if values.size == 1 else values

    def number(self, field, default=None):
        if field not in self:
            if default is None:
                raise BadInput(f"{self.name}.{field} is missing")
            return default
        values = self.array(field)
        if values.shape != ():
            raise BadInput(f"{self.name}.{field} has the shape {values.shape}; it must be one number")
        return float(values)

    def text(self, field, default):
        return self._text_of(self.group[field], field) if field in self else default

    def texts(self, field, default):
        """The texts of a cell array, or a single text."""
        if field not in self:
            return default
        item = self.group[field]
        if isinstance(item, h5py.Dataset) and item.dtype == h5py.ref_dtype:
            return [self._text_of(item.file[reference], field) for reference in item[()].ravel()]
        return [self._text_of(item, field)]

    def _text_of(self, item, field):
        value = item[()]
        if isinstance(value, bytes):
            return value.decode("utf-8")
        if isinstance(value, str):
            return value
        if isinstance(value, np.ndarray) and value.dtype.kind in "ui":  # characters of MATLAB
            return "".join(chr(code) for code in value.T.ravel())
        raise BadInput(f"{self.name}.{field} does not contain text")


def structures(path):
    """{name: Structure} of kgrid, medium and source, and of sensor and options if they exist."""
    try:
        file = h5py.File(path, "r")
    except OSError as error:
        raise BadInput(f"{path} is not an HDF5 file ({error}); in MATLAB, use save(file, '-v7.3', ...)") from error
    found = {}
    for name in ("kgrid", "medium", "source", "sensor", "options"):
        item = file.get(name)
        if isinstance(item, h5py.Group):
            found[name] = Structure(item, name)
        elif item is not None and item.attrs.get("MATLAB_class", b"") not in (b"struct", b"double"):
            raise BadInput(f"{name} was saved as an object, which only MATLAB can read: "
                           f"save {name} = struct('Nx', kgrid.Nx, ...) instead (docs/how-to/kwave.md)")
    for name in ("kgrid", "medium", "source"):
        if name not in found:
            raise BadInput(f"{path} has no structure {name}")
    return found
