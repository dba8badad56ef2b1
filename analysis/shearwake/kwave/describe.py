# SPDX-License-Identifier: BSD-3-Clause
"""Describes an imported simulation, so that a wrong order of indices can be recognised."""
from __future__ import annotations

from typing import Any

import numpy as np

from ..report.words import counted
from .checks import supported_frequency_Hz
from .study import Study


def extent(nodes: np.ndarray, study: Study) -> str:
    """The range of indices along each axis, counted from 1 in the grid of kgrid."""
    if not len(nodes):
        return "none"
    at = nodes - study.first + 1
    ranges = [f"{axis} {low}" if low == high else f"{axis} {low} to {high}"
              for axis, low, high in zip("xyz"[:study.dimensions], at.min(axis=0), at.max(axis=0))]
    return f"{counted(len(nodes), 'node')}, {', '.join(ranges)}"


def of_axes(values: np.ndarray) -> str:
    """The values of the axes, or one if they are equal."""
    return f"{values[0]:g}" if len(set(values)) == 1 else ", ".join(f"{value:g}" for value in values)


def grid_lines(study: Study) -> list[str]:
    """The size, the absorbing layer and the resolved frequencies."""
    used = slice(study.dimensions)
    size = " x ".join(f"{mm:.6g}" for mm in (1e3 * (study.points - 2 * study.first) * study.spacing_m)[used])
    if np.all(study.layer_points == 0.0) or np.all(study.layer_strength == 0.0):
        layer = "none"
    else:
        layer = f"PMLSize {of_axes(study.layer_points[used])}, {'outside' if np.any(study.first) else 'inside'} the grid"
    return [f"size: {size} mm, spacing {of_axes(1e3 * study.spacing_m[used])} mm",
            f"absorbing layer (PML): {layer}, PMLAlpha {of_axes(study.layer_strength[used])}, "
            f"MultiAxialPMLRatio {study.layer_ratio:g}",
            f"maximum supported frequency: {supported_frequency_Hz(study):.4g} Hz"]


def lines_of(study: Study) -> list[str]:
    """Lines about the grid, each group of sources with the same nodes, and the sensor."""
    groups: dict[bytes, list[dict[str, Any]]] = {}
    for source in study.sources:
        groups.setdefault(source["nodes"].tobytes(), []).append(source)
    lines = [*grid_lines(study)]
    lines += [f"source {', '.join(source['field'] for source in group)} ({group[0]['mode']}): "
              f"{extent(group[0]['nodes'], study)}" for group in groups.values()]
    of = "" if study.sensor_weights is None else f"{counted(len(study.sensor_weights), 'point')} between "
    lines.append(f"sensor ({', '.join(study.sensor_fields)}): {of}{extent(study.sensor_nodes, study)}")
    return lines


def summary_of(name: object, study: Study) -> str:
    used = slice(study.dimensions)
    points = (study.points - 2 * study.first)[used]
    outside = f" in an absorbing layer of {', '.join(str(int(n)) for n in study.first[used])}" if np.any(study.first) else ""
    return (f"{name}: {' x '.join(str(int(n)) for n in points)} nodes{outside}, "
            f"{counted(study.steps, 'step')} of {1e6 * study.time_step_s:.6g} us, "
            f"{counted(len(study.sources), 'source')}, {counted(len(study.sensor_nodes), 'sensor node')}")
