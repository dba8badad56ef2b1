# SPDX-License-Identifier: BSD-3-Clause
"""The structures of pstdElastic2D as those of a grid with Nz = 1, which is one plane of pstdElastic3D."""
from __future__ import annotations

import numpy as np

from .structures import BadInput, Structure, text_of

LAYER_POINTS, LAYER_STRENGTH = 20, 2.0  # PMLSize and PMLAlpha of pstdElastic2D: kspaceFirstOrder_setDefaults.m
OUT_OF_PLANE = {"uz", "szz", "sxz", "syz"}


def is_plane(kgrid: Structure) -> bool:
    """Whether the grid has no axis z: in kWaveGrid, Nz and dz are 0 in two dimensions."""
    points, spacing_m = (kgrid.number(name, 0.0) for name in ("Nz", "dz"))
    return points == 1 or (points == 0 and ("Nz" in kgrid or spacing_m == 0.0))


def along_axes(options: Structure, name: str, default: float) -> None:
    """Adds to one or two values of an option that of the axis z, along which there is no layer."""
    if name in options and text_of(options.values[name]) == "auto":
        return
    values = np.ravel(options.array(name) if name in options else default)
    if values.size not in (1, 2):
        raise BadInput(f"options.{name} must be one number or two, 0 or more")
    options.values[name] = np.array([values[0], values[-1], 0.0])


def sensor_mask(mask: np.ndarray, points: tuple[int, ...]) -> np.ndarray:
    """A mask of nodes (Nx, Ny, 1), corners (6, C) or coordinates (3, N), as k-Wave distinguishes them."""
    mask = np.atleast_1d(mask)
    if mask.shape == points:
        return mask[..., None]
    rows = mask.reshape(len(mask), -1)
    if mask.ndim <= 2 and len(mask) == 4:
        return np.insert(rows, [2, 4], 1.0, axis=0)
    if mask.ndim <= 2 and len(mask) == 2:
        return np.insert(rows, 2, 0.0, axis=0)
    raise BadInput(f"sensor.mask has the shape {mask.shape}; it must have the shape {points} of the grid, 4 rows (corners of rectangles) "
                   "or 2 rows (coordinates)" + ("; it appears to be transposed" if mask.ndim == 2 and mask.shape[1] in (2, 4) else ""))


def in_space(parts: dict[str, Structure]) -> dict[str, Structure]:
    """The structures of a plane as those of a grid with Nz = 1, of which `is_plane` holds. Raises BadInput."""
    kgrid = parts["kgrid"]
    fields = {name: dict(structure.values) for name, structure in parts.items()}
    fields.setdefault("options", {})
    points = tuple(int(kgrid.number(name)) for name in ("Nx", "Ny"))
    fields["kgrid"].update(Nz=np.asarray(1.0), dz=np.asarray(kgrid.number("dx")))
    for name in ("medium", "source"):
        for field, value in fields[name].items():
            if name == "source" and field in OUT_OF_PLANE and value is not None:
                raise BadInput(f"source.{field} is not a field that pstdElastic2D uses: a plane has no axis z")
            is_map = name == "medium" or field in ("p0", "u_mask", "s_mask")
            if is_map and isinstance(value, np.ndarray) and value.ndim == 2 and value.size > 1:
                fields[name][field] = value[..., None]
    if "sensor" in parts and "mask" in parts["sensor"]:
        fields["sensor"]["mask"] = sensor_mask(parts["sensor"].array("mask"), points)
    found = {name: Structure(values, name) for name, values in fields.items()}
    along_axes(found["options"], "PMLSize", LAYER_POINTS)
    along_axes(found["options"], "PMLAlpha", LAYER_STRENGTH)
    return found
