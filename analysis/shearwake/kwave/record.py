# SPDX-License-Identifier: BSD-3-Clause
"""The sensor of a study: its nodes, and what it records from the names in k-Wave's sensor.record."""
from __future__ import annotations

from collections.abc import Callable, Iterable

import numpy as np

from .structures import BadInput, Simulation, Structure

FIELDS = ["ux", "uy", "uz", "sxx", "syy", "szz", "sxy", "sxz", "syz"]
GRID = ("max_all", "min_all", "final")  # suffixes of records of the entire grid
SENSOR = ("max", "min", "rms")          # and of records at the sensor
SERIES = ("p", "u", "u_non_staggered", "u_split_field", "I")
NAMES = [*SERIES, "I_avg", *(f"{quantity}_{suffix}" for quantity in "pu" for suffix in SENSOR + GRID)]


def flags_of(records: Iterable[str]) -> list[str]:
    """The options of `shearwake kwave` for records of k-Wave."""
    return sorted(f"--{record}_raw" if record in SERIES else f"--{record}" for record in records)


def recorded_fields(record: Iterable[str]) -> list[str]:
    """The names of sensor.record in a fixed order."""
    names = set(record)
    if unknown := sorted(names - set(NAMES)):
        raise BadInput(f"sensor.record {unknown[0]!r} is unknown; known are {', '.join(NAMES)}")
    return [name for name in NAMES if name in names]


def read_sensor(study: Simulation, sensor: Structure, nodes_of: Callable[[np.ndarray, str], tuple[np.ndarray, np.ndarray]]) -> None:
    """Nodes of the sensor in the order of its rows. With weights (point, 8), the points are sums of eight nodes each, in a plane
    of four."""
    study.sensor_fields = recorded_fields(sensor.texts("record", ["p"]))
    study.sensor_nodes, study.sensor_weights, study.cuboids = np.zeros((0, 3), dtype=int), None, None
    start = sensor.number("record_start_index", 1.0)
    study.sensor_start = int(start)
    if study.sensor_start != start or not 1 <= start <= study.steps:
        raise BadInput(f"sensor.record_start_index is {start:g}; it must be a whole number from 1 to kgrid.Nt = "
                       f"{study.steps}")
    if "mask" not in sensor:
        study.sensor_fields = [name for name in study.sensor_fields if name.endswith(GRID)] or ["p_final"]
        study.notes.append(f"sensor.mask is missing: only values of the entire grid are recorded, {', '.join(study.sensor_fields)}")
        return
    mask = np.atleast_1d(sensor.array("mask"))
    if mask.ndim == 3:
        study.sensor_nodes, _ = nodes_of(mask, "sensor.mask")
    elif mask.ndim in (1, 2) and mask.shape[0] == 6:
        read_corners(study, mask)
    elif mask.shape[0] == 3:
        read_points(study, mask.reshape(3, -1).T / study.spacing_m)
    else:
        transposed = mask.ndim == 2 and mask.shape[1] in (3, 6)
        raise BadInput(f"sensor.mask has the shape {mask.shape}; it must have the shape of the grid, 6 rows "
                       "(corners of cuboids) or 3 rows (coordinates)" +
                       ("; it appears to be transposed" if transposed else ""))
    if "u_split_field" in study.sensor_fields and study.sensor_weights is not None:
        raise BadInput("sensor.record 'u_split_field' is not available at Cartesian points")
    if "u_split_field" in study.sensor_fields and study.cuboids is not None:  # as in k-Wave
        study.sensor_fields.remove("u_split_field")
        study.notes.append("sensor.record 'u_split_field' is not recorded: as in k-Wave, it is not available for cuboids")


def read_corners(study: Simulation, mask: np.ndarray) -> None:
    """Corners of cuboids, counted from 1."""
    if np.any(between := mask % 1.0 != 0.0):
        raise BadInput(f"sensor.mask contains the corner {mask[between].flat[0]:g}; the corners of cuboids must be whole "
                       "numbers, the indices of nodes")
    check_inside(study, mask.reshape(2, 3, -1).transpose(0, 2, 1).reshape(-1, 3) - 1.0)
    study.cuboids = mask.reshape(6, -1).T.astype(int) - 1
    if np.any(study.cuboids[:, 3:] < study.cuboids[:, :3]):
        axes = "xyz"[:study.dimensions]
        raise BadInput("sensor.mask contains a cuboid whose second corner lies before the first; they must be "
                       f"{', '.join(f'{axis}{corner}' for corner in (1, 2) for axis in axes)} with "
                       f"{', '.join(f'{axis}1 <= {axis}2' for axis in axes[:-1])} and {axes[-1]}1 <= {axes[-1]}2, as in k-Wave")
    study.sensor_nodes = np.concatenate([
        np.stack([i.ravel(order="F") for i in np.meshgrid(
            *[np.arange(box[a], box[a + 3] + 1) for a in range(3)], indexing="ij")], axis=1)
        for box in study.cuboids]) + study.first


def read_points(study: Simulation, from_centre: np.ndarray) -> None:
    """Cartesian points between the nodes, in spacings from the central node, (point, axis)."""
    points, centre = study.points - 2 * study.first, (study.points - 2 * study.first) // 2
    interpolation = study.options.text("CartInterp", "linear")
    if interpolation not in ("linear", "nearest"):
        raise BadInput(f"options.CartInterp is \"{interpolation}\"; it must be \"linear\" or \"nearest\"")
    if interpolation == "nearest":  # of the points at one node only the last remains, as in k-Wave
        # round() of MATLAB: half away from zero. In cart2grid of k-Wave, the index of the centre is added afterwards: the
        # rounding error of an earlier sum would move points near the half.
        truncated = np.trunc(from_centre)
        at = truncated + np.sign(from_centre) * (np.abs(from_centre - truncated) >= 0.5) + centre
        check_inside(study, at)
        last = {tuple(node): number for number, node in enumerate(at.astype(int))}
        study.sensor_nodes = np.array(sorted(last, key=last.__getitem__)) + study.first
        return
    at = from_centre + centre
    if not np.all((at > -1e-9) & (at < points - 1 + 1e-9)):  # also for NaN
        raise BadInput("sensor.mask has points outside of the grid")
    low = np.clip(np.floor(at + 1e-9).astype(int), 0, np.maximum(points - 2, 0))
    share = np.clip(at - low, 0.0, 1.0)  # 1e-9 of a cell is a rounding error of the coordinates
    corners = np.array(np.meshgrid(*[range(min(2, n)) for n in points], indexing="ij")).reshape(3, -1).T
    study.sensor_nodes = (low[:, None, :] + corners).reshape(-1, 3) + study.first
    study.sensor_weights = np.prod(np.where(corners, share[:, None, :], 1.0 - share[:, None, :]), axis=2)
    study.notes.append("sensor.mask: values at Cartesian points are interpolated linearly between nodes")


def check_inside(study: Simulation, nodes: np.ndarray) -> None:
    """Nodes (node, axis) must lie in the grid of the study, without an absorbing layer outside of it."""
    if not np.all((nodes >= 0) & (nodes < study.points - 2 * study.first)):  # also for NaN
        raise BadInput("sensor.mask has points outside of the grid")
